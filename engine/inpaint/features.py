"""The input features of the filling network."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from engine.controls import CONTROLS, bundled_measurer
from engine.inpaint.gap import Gap
from engine.inpaint.seams import nearest_known
from engine.inpaint.statistics import Statistics
from engine.speech.visemes import NAMES
from engine.take import SHAPES, Array

FEATURES = 3 * len(SHAPES) + 1 + len(NAMES) + 3 * len(CONTROLS) + 2


@dataclass(frozen=True)
class Tuning:
    """Scales of the features; part of the trained network, so that a change asks for a new training."""

    near_frames: float = 8.0  # frames, decay of the feature for nearness to known frames; range not recorded


TUNING = Tuning()


def features_of(gap: Gap, base: Array, statistics: Statistics) -> np.ndarray:
    """Return the network's input, (frames, FEATURES) float32, for a gap and its base motion, (frames, 52).

    In order: base and its velocity in standard deviations, which weights are missing, whether there is a guide, visemes,
    controls of the base and their distance to the targets in standard deviations, which controls have a target, and how
    near known frames are.
    """
    nearest = nearest_known(gap.known)
    measured = bundled_measurer().measure(base)
    unit = np.sqrt(np.diag(statistics.spread))
    targeted = np.isfinite(gap.controls)
    parts = [
        (base - statistics.mean) / statistics.scale,
        np.gradient(base, axis=0) / statistics.scale if len(base) > 1 else np.zeros_like(base),
        np.isnan(gap.known),
        np.isfinite(gap.guide).any(axis=1, keepdims=True),
        gap.visemes,
        (measured - statistics.rest) / unit,
        np.where(targeted, gap.controls - measured, 0.0) / unit,
        targeted,
        np.exp(-nearest / TUNING.near_frames)[:, None],
        np.log1p(nearest)[:, None] / 4,
    ]
    return np.concatenate(parts, axis=1).astype(np.float32)


def features_without_controls(gap: Gap, base: Array, statistics: Statistics) -> np.ndarray:
    """Return the features, (frames, FEATURES) float32, of a base that met control targets, with the targets left out."""
    return features_of(replace(gap, controls=np.full_like(gap.controls, np.nan)), base, statistics)
