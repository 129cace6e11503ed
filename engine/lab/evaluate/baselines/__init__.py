"""What the regressor is measured against: one module each, trained on the same takes with the same augmentation."""

from __future__ import annotations

from typing import Protocol

from engine.models.checkpoint import MODELS
from engine.take import Array

FOLDER = MODELS / "baselines"
NAMES = ("hsk16", "ridge", "bsbs19")  # those that ship; each is a module of this package


class Baseline(Protocol):
    """Control curves to a face."""

    def infer(self, controls: Array) -> Array:
        """Return weights, (frames, 52) and not clamped, of controls, (frames, 8) in mm."""
        ...
