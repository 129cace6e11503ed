"""Lip closure at bilabials: a fill whose lips stay open at M, B or P looks wrong first."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engine import exact
from engine.controls import CONTROL_INDEX, bundled_measurer
from engine.easing import ease
from engine.inpaint.gap import Gap
from engine.inpaint.regions import REGIONS
from engine.inpaint.seams import distance_frames
from engine.speech.visemes import NAMES
from engine.take import Array


@dataclass(frozen=True)
class Tuning:
    """When lips count as closed, and how fast they close; not tuned."""

    shut_mm: float = 1.0  # mm between the lips at a bilabial
    ease_frames: float = 4.0  # frames over which the lips come together and part again


TUNING = Tuning()
_LIPS = np.array([CONTROL_INDEX["lips_vertical"]])
_MBP = NAMES.index("mbp")


def close_lips(motion: Array, gap: Gap) -> Array:
    """Project generated motion, (frames, 52), onto lips no wider than `shut_mm` at frames with a bilabial viseme.

    The least change of the weights of the lower face (`engine.exact`); known values stay as they are, and where the lips
    have a control target, the target decides.
    """
    bilabial = (gap.visemes[:, _MBP] > 0) & np.isnan(gap.controls[:, _LIPS[0]])
    free = np.isnan(gap.known)
    if not (bilabial & free.any(axis=1)).any():
        return motion
    away = distance_frames(np.where(bilabial, 0.0, np.nan)[:, None])[:, 0]
    nearness = np.clip(1 - away / TUNING.ease_frames, 0.0, 1.0)
    lips = bundled_measurer().measure(motion)[:, _LIPS]
    target = lips - ease(nearness)[:, None] * np.maximum(0.0, lips - TUNING.shut_mm)
    rows = (target < lips)[:, 0]
    if not rows.any():
        return motion
    moved = motion.copy()
    lower = REGIONS["lower"] & free.any(axis=0)
    moved[rows] = exact.project(motion[rows], target[rows], _LIPS, bundled_measurer(), free=lower)
    return np.where(free, moved, motion)
