"""What is known about a stretch of motion with a hole in it, and the plain face that the network starts from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import gaussian_filter1d

from engine.controls import CONTROLS, bundled_measurer
from engine.inpaint.expected import bundled as bundled_expected
from engine.inpaint.lend import lent, trust
from engine.inpaint.seams import REACH_FRAMES, bridge, distance_frames, room_frames, smoothed
from engine.speech.visemes import NAMES
from engine.take import SHAPES, Array, Mask

RISE_FRAMES = 6.0  # how soon beside a known frame the network may move the face; of 2.5 ... 9 on validation takes
# How slowly a face far from known frames comes to rest. Absolute errors teach medians: what moves seldom lay flat at
# nought all along a span, which cost half of its NPSS. Of 10 ... 250 on validation takes; one per cent of error at 3 s.
REST_FRAMES = 100.0
GUIDE_SMOOTHING = 2  # passes over a guide, of 2 ... 10 on validation takes
GUIDE_FRAMES = 1.6  # how far from known frames a guide begins to tell more than they do; likewise
# What a guide is believed against: so many times its jitter, such a share of its level for a wrong gain, and so little.
JITTER, GAIN, LEAST = 1.25, 0.2, 0.005
_FULL = 1.2  # of the filter's answer; so much is lost to smoothing
ROOM_FRAMES = 2.0  # between seams nearer than this a face has no time to go where a guide leads; of 1 ... 4 likewise
_AROUND = 4.0  # frames over which jitter and level of a guide are measured
_NEAR_FRAMES = 8.0  # scale on which nearness to known frames is shown to the network
_SETTLED_FRAMES = 12.0  # how far from known frames motion is still largely settled by them
_EASING = 8  # passes over where controls begin and end to be asked
CARRY_FRAMES = 30.0  # how slowly a face leaves the seams for the one that controls let expect; of 10 ... 100 likewise
# Motion this small is slight, of 0.003 ... 0.02, and between seams this near it counts for half, of 0 ... 6 frames.
SLIGHT, _ROOM = 0.005, 6.0
LIFE_FRAMES = 30.0  # how far from known frames life comes under controls
_CONTROL_NOISE = 0.5  # mm; what a control curve is trusted to, of 0.1 ... 2 on validation takes

FEATURES = 3 * len(SHAPES) + 1 + len(NAMES) + 3 * len(CONTROLS) + 2


@dataclass(frozen=True, eq=False)
class Gap:
    """A stretch of motion at the model rate with what is known of it; NaN is what is not.

    Attributes
    ----------
    known : (frames, 52) weights: context and pins; NaN where motion is to be made
    guide : (frames, 52) weights of a rough performance to follow
    visemes : (frames, 18) one-hot, all zero where nothing is said of the frame
    controls : (frames, 8) mm, asked control curves
    rest : (frames, 52) each, what else of the take is known: stretches without holes at the model rate
    """

    known: Array
    guide: Array
    visemes: Array
    controls: Array
    rest: Sequence[Array] = ()

    @property
    def guided(self) -> Mask:
        """Which frames a guide, visemes or controls say something of, (frames,) bool."""
        told = np.isfinite(self.guide).any(axis=1) | np.isfinite(self.controls).any(axis=1)
        return np.asarray(told | self.visemes.any(axis=1))


def gap_of(
    known: Array,
    *,
    guide: Array | None = None,
    visemes: Array | None = None,
    controls: Array | None = None,
    rest: Sequence[Array] = (),
) -> Gap:
    """Return a gap with whatever guidance there is."""
    frames = len(known)
    return Gap(
        known,
        np.full((frames, len(SHAPES)), np.nan) if guide is None else guide,
        np.zeros((frames, len(NAMES))) if visemes is None else visemes,
        np.full((frames, len(CONTROLS)), np.nan) if controls is None else controls,
        rest,
    )


@dataclass(frozen=True, eq=False)
class Statistics:
    """How weights and controls vary together over the training takes.

    Attributes
    ----------
    mean, scale : (52,) of the weights
    rest : (8,) mm, mean of the controls
    spread : (8, 8) mm^2, covariance of the controls
    cross : (8, 52) mm, covariance of controls with weights
    """

    mean: Array
    scale: Array
    rest: Array
    spread: Array
    cross: Array


def statistics_of(weights: Array) -> Statistics:
    """Return the statistics of many faces, (faces, 52)."""
    controls = bundled_measurer().measure(weights)
    mean, rest = weights.mean(axis=0), controls.mean(axis=0)
    off, away = weights - mean, controls - rest
    return Statistics(
        mean, np.maximum(weights.std(axis=0), 0.02), rest, away.T @ away / len(away), away.T @ off / len(away)
    )


@dataclass(frozen=True, eq=False)
class Ground:
    """What the network adds to, and what it is shown.

    Attributes
    ----------
    base : (frames, 52) a smooth face through all that is known, bent to guide and controls
    rise : (frames, 52) in 0..1, how much of the network's motion is let in: none at known values
    features : (frames, FEATURES) float32
    certainty : (frames,) in 0..1, how far what is known settles the pose: one beside known frames and where guided
    lent : (frames, 52) in 0..1, how much of the base is motion lent by the rest of the take
    """

    base: Array
    rise: Array
    features: np.ndarray
    certainty: Array
    lent: Array


def ground(gap: Gap, statistics: Statistics, rank: int = 0) -> Ground:
    """Return the face under a fill: through seams and pins with their slopes, along the guide, bent to the controls.

    Where nothing steers, it goes along the `rank`-th nearest stretch of the rest of the take. Straight lines between
    seams, or the face at rest, are what every fill of a long hole then strays about: faces varied half as much as real.

    With this under it the network's output needs no reconstruction term outside the mask (the first half of BSS20
    equation 1): what is known stays as it is, to the last bit.
    """
    distance = distance_frames(gap.known)
    rise = 1 - np.exp(-((distance / RISE_FRAMES) ** 2))
    base = _as_expected(_along_guide(gap, distance, statistics), gap)
    slow = None if gap.guided.any() else lent(gap.known, gap.rest, statistics.scale, rank)
    share = np.zeros_like(base) if slow is None else trust(gap.known)
    base = base if slow is None else np.clip(base + share * (slow - base), 0.0, 1.0)
    base = np.where(np.isnan(gap.known), bent(base, rise, gap.controls, statistics), gap.known)
    nearest = _nearest(gap, distance)
    certainty = np.where(gap.guided, 1.0, np.exp(-nearest / _SETTLED_FRAMES))
    return Ground(base, rise, _features(gap, base, nearest, statistics), certainty, share)


def resting(known: Array, statistics: Statistics) -> Array:
    """Return what to add to motion made in a long hole, (frames, 52), so that it leans to the face at rest.

    The difference between the curves through `known` that slowly come to rest and those that do not.
    """
    pull = np.full(len(known), 1 / (REACH_FRAMES * REST_FRAMES) ** 2)
    away = known - statistics.mean
    leant: Array = bridge(away, hold=pull) - bridge(away)
    return leant


def _nearest(gap: Gap, distance: Array) -> Array:
    """Return how far each frame is from where some of its unknown shapes are known, (frames,)."""
    nearest = np.where(np.isnan(gap.known), distance, np.inf).min(axis=1)
    return np.where(np.isfinite(nearest), nearest, 0.0)


def _along_guide(gap: Gap, distance: Array, statistics: Statistics) -> Array:
    """Return curves through all that is known, along the guide without its jitter, and at rest where nothing is known."""
    plain = np.where(np.isnan(gap.known).all(axis=0), statistics.mean, bridge(gap.known))
    told: Mask = np.isnan(gap.known) & np.isfinite(gap.guide)
    if not told.any():
        return plain
    guide = np.where(told, gap.guide, plain)
    share = distance**2 / (distance**2 + GUIDE_FRAMES**2)
    away = share * smoothed(guide - plain, GUIDE_SMOOTHING)
    room = room_frames(gap.known)
    return plain + _belief(away * room / (room + ROOM_FRAMES), guide, told) * away


def _belief(away: Array, guide: Array, told: Mask) -> Array:
    """Return how far a guide is followed, (frames, 52) in 0..1, where it may lead `away` from the plain curve.

    Wiener's filter with powers measured around each frame: what exceeds the guide's jitter and what a wrong gain would
    do is believed. Followed everywhere alike, still shapes shook, which cost a third of the error.
    """
    jitter, there = np.zeros_like(guide), np.zeros_like(told)
    jitter[1:-1] = np.diff(guide, n=2, axis=0) ** 2 / 6  # white noise of variance v has 6 v in its second differences
    there[1:-1] = told[:-2] & told[1:-1] & told[2:]
    power, level = _mean_around(away**2, told), _mean_around(guide, told)
    doubt = JITTER**2 * _mean_around(jitter, there) + (GAIN * level) ** 2 + LEAST**2
    return np.asarray(np.minimum(1.0, _FULL * power / (power + doubt)))


def _mean_around(values: Array, there: Mask) -> Array:
    """Return the mean of the values that are there around each frame, (frames, n)."""
    blurred = (gaussian_filter1d(x, _AROUND, axis=0, mode="constant") for x in (values * there, there.astype(float)))
    total, count = blurred
    return np.asarray(total / np.maximum(count, 1e-6))


def _as_expected(base: Array, gap: Gap) -> Array:
    """Return the face to expect where controls are asked, carried onto all that is known; a guide tells more than it."""
    asked = np.isfinite(gap.controls)
    if not asked.any() or np.isfinite(gap.guide).any():
        return base
    hole: Mask = np.asarray(np.isnan(gap.known).any(axis=1))
    around = np.where(asked.any(axis=0), bundled_measurer().measure(base), np.nan)
    face = bundled_expected().face(np.where(hole[:, None], gap.controls, around))
    carry = np.full(len(base), 1 / (REACH_FRAMES * CARRY_FRAMES) ** 2)
    rows = np.flatnonzero(hole)
    told = smoothed(np.interp(np.arange(len(base)), rows, asked[rows].any(axis=1))[:, None], _EASING)
    return base + told * (face + bridge(gap.known - face, hold=carry) - base)


def bent(base: Array, rise: Array, controls: Array, statistics: Statistics) -> Array:
    """Move a face, (frames, 52), towards asked controls by linear regression on those that are asked for."""
    asked = np.isfinite(controls)
    if not asked.any():
        return base
    missing = np.where(asked, controls - bundled_measurer().measure(base), 0.0)
    moved = np.array(base)
    for pattern in np.unique(asked, axis=0):
        if pattern.any():
            rows, columns = (asked == pattern).all(axis=1), np.flatnonzero(pattern)
            moved[rows] += rise[rows] * (missing[np.ix_(rows, columns)] @ _gain(columns, statistics))
            moved[rows] = np.where(rise[rows] > 0, np.clip(moved[rows], 0.0, 1.0), base[rows])
    return moved


def _gain(columns: np.ndarray, statistics: Statistics) -> Array:
    """Return how weights follow some controls on average, (controls, 52) per mm."""
    spread = statistics.spread[np.ix_(columns, columns)] + _CONTROL_NOISE**2 * np.eye(len(columns))
    return np.asarray(np.linalg.solve(spread, statistics.cross[columns]))


def substantial(motion: Array, gap: Gap) -> Array:
    """Return motion to add, (frames, 52), without what is slight where something steers, and the more so between near seams.

    A network moves every shape a little, also the many that keep still; over a fifth of a second that undid all that
    visemes had told it.
    """
    room = room_frames(gap.known)
    power = gaussian_filter1d((motion * room / (room + _ROOM)) ** 2, _AROUND, axis=0)
    return np.where(gap.guided[:, None], motion * power / (power + SLIGHT**2), motion)


def left_open(gap: Gap, statistics: Statistics) -> Array:
    """Return how much of each weight's spread asked controls leave open, (frames, 52) in 0..1.

    None where no control is asked, along a guide and beside what is known.
    """
    asked = np.isfinite(gap.controls)
    columns = np.flatnonzero(asked.any(axis=0))
    settled = (statistics.cross[columns] * _gain(columns, statistics)).sum(axis=0) / statistics.scale**2
    far = 1 - np.exp(-_nearest(gap, distance_frames(gap.known)) / LIFE_FRAMES)
    told = asked.any(axis=1) & ~np.isfinite(gap.guide).any(axis=1)
    return np.asarray((far * told)[:, None] * np.sqrt(np.clip(1 - settled, 0.0, 1.0)))


def unsteered(gap: Gap, base: Array, statistics: Statistics) -> np.ndarray:
    """Return features, (frames, FEATURES) float32, that show a base without the controls that it was bent to."""
    loose = replace(gap, controls=np.full_like(gap.controls, np.nan))
    return _features(loose, base, _nearest(gap, distance_frames(gap.known)), statistics)


def _features(gap: Gap, base: Array, nearest: Array, statistics: Statistics) -> np.ndarray:
    measured = bundled_measurer().measure(base)
    unit = np.sqrt(np.diag(statistics.spread))
    asked = np.isfinite(gap.controls)
    parts = [
        (base - statistics.mean) / statistics.scale,
        np.gradient(base, axis=0) / statistics.scale if len(base) > 1 else np.zeros_like(base),
        np.isnan(gap.known),
        np.isfinite(gap.guide).any(axis=1, keepdims=True),
        gap.visemes,
        (measured - statistics.rest) / unit,
        np.where(asked, gap.controls - measured, 0.0) / unit,
        asked,
        np.exp(-nearest / _NEAR_FRAMES)[:, None],
        np.log1p(nearest)[:, None] / 4,
    ]
    return np.concatenate(parts, axis=1).astype(np.float32)
