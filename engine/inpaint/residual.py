"""How much of the network's residual is added to the base motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from engine.inpaint.gap import Gap
from engine.inpaint.seams import harmonic_frames, nearest_known
from engine.inpaint.statistics import Statistics, regression
from engine.take import Array


@dataclass(frozen=True)
class Tuning:
    """Gates of the residual; the range tried on validation takes in brackets."""

    small_motion: float = 0.004  # weight [0.003 .. 0.04]; motion of this size is halved under guidance
    room_frames: float = 30.0  # frames [2 .. 30]; between seams this near, motion counts for half its size
    window_frames: float = 4.0  # frames, standard deviation of the window for the power of motion
    detail_frames: float = 30.0  # frames from known ones over which detail comes in under control targets


TUNING = Tuning()


def gate_small_motion(motion: Array, gap: Gap) -> Array:
    """Return a residual, (frames, 52), without its small motion at guided frames, the more so between near seams.

    ``m P / (P + small_motion^2)`` with P the power of m around each frame. The network moves every shape a little, also
    the many that keep still; over a fifth of a second that undid all that visemes had brought.
    """
    room = harmonic_frames(gap.known)
    power = gaussian_filter1d((motion * room / (room + TUNING.room_frames)) ** 2, TUNING.window_frames, axis=0)
    return np.where(gap.guided[:, None], motion * power / (power + TUNING.small_motion**2), motion)


def unexplained_share(gap: Gap, statistics: Statistics) -> Array:
    """Return the share of each weight's standard deviation that the control targets leave unexplained.

    ``sqrt(1 - R^2)`` of the regression on them, (frames, 52) in 0..1; 0 where no control has a target, along a guide
    and beside known frames.
    """
    targeted = np.isfinite(gap.controls)
    columns = np.flatnonzero(targeted.any(axis=0))
    explained = (statistics.cross[columns] * regression(columns, statistics)).sum(axis=0) / statistics.scale**2
    far = 1 - np.exp(-nearest_known(gap.known) / TUNING.detail_frames)
    controlled = targeted.any(axis=1) & ~np.isfinite(gap.guide).any(axis=1)
    return np.asarray((far * controlled)[:, None] * np.sqrt(np.clip(1 - explained, 0.0, 1.0)))
