"""Lips that meet where M, B or P is said: a fill that misses a bilabial looks wrong first."""

from __future__ import annotations

import numpy as np

from engine import exact
from engine.controls import CONTROL_INDEX, bundled_measurer
from engine.easing import ease
from engine.inpaint.gap import Gap
from engine.inpaint.regions import REGIONS
from engine.inpaint.seams import distance_frames
from engine.speech.visemes import NAMES
from engine.take import Array

SHUT_MM = 1.0
EASE_FRAMES = 4.0  # over which the lips come together and part again
_LIPS = np.array([CONTROL_INDEX["lips_vertical"]])
_MBP = NAMES.index("mbp")


def shut_lips(made: Array, gap: Gap) -> Array:
    """Return made motion, (frames, 52), with the lips brought together where the visemes say so, moving least.

    Known values stay as they are; where a curve is asked for the lips, it has the last word.
    """
    said = (gap.visemes[:, _MBP] > 0) & np.isnan(gap.controls[:, _LIPS[0]])
    free = np.isnan(gap.known)
    if not (said & free.any(axis=1)).any():
        return made
    away = distance_frames(np.where(said, 0.0, np.nan)[:, None])[:, 0]
    nearness = np.clip(1 - away / EASE_FRAMES, 0.0, 1.0)
    lips = bundled_measurer().measure(made)[:, _LIPS]
    asked = lips - ease(nearness)[:, None] * np.maximum(0.0, lips - SHUT_MM)
    rows = (asked < lips)[:, 0]
    if not rows.any():
        return made
    moved = made.copy()
    lower = REGIONS["lower"] & free.any(axis=0)
    moved[rows] = exact.project(made[rows], asked[rows], _LIPS, bundled_measurer(), free=lower)
    return np.where(free, moved, made)
