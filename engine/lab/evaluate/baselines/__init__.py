"""What the regressor is measured against: one module each, trained on the same takes with the same augmentation."""

from __future__ import annotations

from typing import Protocol

from engine.models.checkpoint import MODELS
from engine.take import Array

FOLDER = MODELS / "baselines"
NAMES = ("hsk16", "ridge", "bsbs19", "hsk16_16", "ridge_16")  # those that ship, two with the extended controls too


class Baseline(Protocol):
    """Control curves to a face."""

    def infer(self, controls: Array) -> Array:
        """Return weights, (frames, 52) and not clamped, of controls, (frames, 8 or 16)."""
        ...
