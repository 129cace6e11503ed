"""The base motion of a fill, to which the network adds a residual: interpolation, guide, retrieval and regression."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engine.controls import bundled_measurer
from engine.inpaint import seams
from engine.inpaint.expected import bundled as bundled_expected
from engine.inpaint.features import features_of
from engine.inpaint.gap import Gap
from engine.inpaint.guide import along_guide
from engine.inpaint.retrieval import retrieval_share, retrieve
from engine.inpaint.seams import binomial_smooth, bridge, distance_frames, nearest_known
from engine.inpaint.statistics import Statistics, regress_controls
from engine.take import Array, Mask


@dataclass(frozen=True)
class Tuning:
    """Scales of the base motion in frames; the range tried on validation takes in brackets."""

    blend_frames: float = 6.0  # frames from known ones over which the residual comes in [2.5 .. 9]
    # Frames over which a face far from known frames relaxes to the mean pose [10 .. 250]. Errors in absolute value teach
    # medians: shapes that seldom move lay flat at zero all along a span, which cost half of its NPSS; MAE at 3 s +1 %.
    relax_frames: float = 100.0
    settled_frames: float = (
        12.0  # frames from known ones over which they still determine the motion; range not recorded
    )
    expected_frames: float = 30.0  # frames over which seams give way to the expected pose [10 .. 100]
    easing_passes: int = 8  # of the filter 1/4, 1/2, 1/4 where control targets begin and end; range not recorded


TUNING = Tuning()


@dataclass(frozen=True, eq=False)
class Base:
    """The base motion and what the network is given with it.

    Attributes
    ----------
    base : (frames, 52) weights: smooth through all that is known, along guide, retrieved motion and control targets
    blend : (frames, 52) in 0..1, share of the network's residual that is added: none at known values
    features : (frames, FEATURES) float32, input of the network
    certainty : (frames,) in 0..1, how far context and guidance determine the pose: 1 beside known frames and where guided
    retrieved : (frames, 52) in 0..1, share of the base that is motion retrieved from the rest of the take
    """

    base: Array
    blend: Array
    features: np.ndarray
    certainty: Array
    retrieved: Array


def base_of(gap: Gap, statistics: Statistics, rank: int = 0) -> Base:
    """Return the base motion: through seams and pins with their slopes, along the guide, moved to the control targets.

    Without guidance it follows the `rank`-th nearest stretch of the rest of the take. About straight lines between
    seams, or about the mean pose, every fill of a long gap varied half as much as real motion.

    On this base the network's output needs no reconstruction term outside the mask (first half of BSS20 equation 1):
    known values stay as they are, bit for bit.
    """
    distance = distance_frames(gap.known)
    blend = 1 - np.exp(-((distance / TUNING.blend_frames) ** 2))
    base = _towards_expected(along_guide(gap, distance, statistics), gap)
    slow = None if gap.guided.any() else retrieve(gap.known, gap.rest, statistics.scale, rank)
    share = np.zeros_like(base) if slow is None else retrieval_share(gap.known)
    base = base if slow is None else np.clip(base + share * (slow - base), 0.0, 1.0)
    base = np.where(np.isnan(gap.known), regress_controls(base, blend, gap.controls, statistics), gap.known)
    nearest = nearest_known(gap.known)
    certainty = np.where(gap.guided, 1.0, np.exp(-nearest / TUNING.settled_frames))
    return Base(base, blend, features_of(gap, base, statistics), certainty, share)


def relaxation(known: Array, statistics: Statistics) -> Array:
    """Return what to add to motion in a long gap, (frames, 52), so that it relaxes to the mean pose.

    The difference between the curves through `known` with a pull towards the mean and those without.
    """
    pull = np.full(len(known), 1 / (seams.TUNING.reach_frames * TUNING.relax_frames) ** 2)
    away = known - statistics.mean
    difference: Array = bridge(away, hold=pull) - bridge(away)
    return difference


def _towards_expected(base: Array, gap: Gap) -> Array:
    """Return the base moved to the pose expected of the control targets, corrected onto all that is known.

    Where there is a guide it tells more than the expectation, and the base is returned as it is.
    """
    targeted = np.isfinite(gap.controls)
    if not targeted.any() or np.isfinite(gap.guide).any():
        return base
    hole: Mask = np.asarray(np.isnan(gap.known).any(axis=1))
    around = np.where(targeted.any(axis=0), bundled_measurer().measure(base), np.nan)
    pose = bundled_expected().pose(np.where(hole[:, None], gap.controls, around))
    pull = np.full(len(base), 1 / (seams.TUNING.reach_frames * TUNING.expected_frames) ** 2)
    rows = np.flatnonzero(hole)
    share = np.interp(np.arange(len(base)), rows, targeted[rows].any(axis=1))[:, None]
    share = binomial_smooth(share, TUNING.easing_passes)
    return base + share * (pose + bridge(gap.known - pose, hold=pull) - base)
