"""What a face tracker does to a performance: jitter, spikes, frozen frames, lost runs, lag, amplitude loss, cross-talk.

The strengths that a recording can tell were read off the two dirty takes, `apfel` and `S88-001` (`measure` reads them
off any take); what it cannot tell, lag and cross-talk, is assumed and marked so.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_banded

from engine.anatomy import MIRROR
from engine.lab.performer.augment import LOWER
from engine.quality import leaps, repeats
from engine.take import SHAPE_INDEX, SHAPES, Array, Mask, Take, runs

LIDS = [SHAPE_INDEX[f"eyeBlink{side}"] for side in ("Left", "Right")]
_LEAP = (
    0.15  # weight; articulations of three frames count too: the shipped networks were trained with what this measured
)
_JITTER_MEMORY_S = 0.02  # a tracker's error outlives one frame of a fast camera


@dataclass(frozen=True)
class Faults:
    """How strong each fault is; zero switches it off.

    Attributes
    ----------
    jitter_rest, jitter_active : standard deviation of the jitter of a shape at weight 0 and at weight 1 (measured: 90th
        percentile of half-second stretches)
    spikes_per_s : single frames on which a few shapes leap (measured)
    spike_size : largest leap, in weight (measured)
    frozen_per_s, frozen_s : how often the tracker repeats itself, and the longest repetition (measured: missed frames)
    lost_per_s : how often the face is lost (measured)
    lost_s : lengths of lost runs to draw from, seconds (measured)
    amplitude : smallest share of a motion's size that the tracker reports, drawn per take and part of the face
        (measured: blink peaks of the dirty takes over those of the cleanest one)
    lag_s : longest delay, drawn per take from 0 to this (assumed)
    cross_talk : share of a shape's weight that shows on another shape of the same part (assumed)
    """

    jitter_rest: float = 0.006
    jitter_active: float = 0.07
    spikes_per_s: float = 0.22
    spike_size: float = 0.5
    frozen_per_s: float = 0.04
    frozen_s: float = 0.1
    lost_per_s: float = 0.08
    lost_s: tuple[float, ...] = (0.1, 0.13, 0.1, 0.2, 0.27, 0.1, 0.27, 0.83, 4.1, 4.3)
    amplitude: float = 0.7
    lag_s: float = 0.012
    cross_talk: float = 0.03


NONE = Faults(0, 0, 0, 0, 0, 0, 0, (), 1, 0, 0)


def scaled(faults: Faults, strength: float) -> Faults:
    """Return faults of another strength: 0 is none, 1 as they are."""
    return replace(
        faults,
        jitter_rest=faults.jitter_rest * strength,
        jitter_active=faults.jitter_active * strength,
        spikes_per_s=faults.spikes_per_s * strength,
        frozen_per_s=faults.frozen_per_s * strength,
        lost_per_s=faults.lost_per_s * strength,
        amplitude=1 - (1 - faults.amplitude) * strength,
        lag_s=faults.lag_s * strength,
        cross_talk=faults.cross_talk * strength,
    )


@dataclass(frozen=True, eq=False)
class Tracked:
    """What the tracker delivers.

    Attributes
    ----------
    weights : (frames, 52) float64; a frame without a face repeats the last one that had one
    lost : (frames,) bool
    """

    weights: Array
    lost: Mask


def degrade(weights: Array, times_s: Array, faults: Faults, rng: np.random.Generator) -> Tracked:
    """Return a performance as a tracker with these faults would report it.

    Parameters
    ----------
    weights : (frames, 52) the performance, 0..1
    times_s : (frames,) when each frame was taken, increasing, seconds
    """
    steps = np.diff(times_s, prepend=times_s[0] - np.median(np.diff(times_s)) if len(times_s) > 1 else -1 / 30)
    seen = _late(weights * _amplitude(faults.amplitude, rng), times_s, faults.lag_s * rng.random())
    seen = seen @ _cross_talk(faults.cross_talk, rng)
    seen = seen + _jitter(weights, steps, faults, rng)
    seen = np.clip(_spiked(seen, steps, faults, rng), 0.0, 1.0)
    frozen = _stretches(steps, faults.frozen_per_s, (faults.frozen_s / 3, faults.frozen_s), rng)
    lost = _stretches(steps, faults.lost_per_s, faults.lost_s, rng)
    lost[0] = False
    return Tracked(hold(hold(seen, frozen), lost), lost)


def hold(weights: Array, missing: Mask) -> Array:
    """Return weights, (frames, n), with each missing frame replaced by the last one that is not; a first one stays."""
    last = np.maximum.accumulate(np.where(missing, 0, np.arange(len(weights))))
    return np.asarray(weights[last])


def _amplitude(least: float, rng: np.random.Generator) -> Array:
    """One share for each part of the face, and a little of its own for each shape; both sides share theirs."""
    lower, upper, lids = rng.uniform(least, 1.0, 3)
    shares = np.where(LOWER, lower, upper)
    shares[LIDS] = lids
    own = rng.uniform(-0.1, 0.1, len(SHAPES)) * (1 - least)
    return np.asarray(np.minimum(shares + (own + own[MIRROR]) / 2, 1.0))


def _late(weights: Array, times_s: Array, lag_s: float) -> Array:
    """Return what the face was a moment ago, between frames by a straight line."""
    asked = np.clip(times_s - lag_s, times_s[0], None)
    after = np.clip(np.searchsorted(times_s, asked), 1, len(times_s) - 1)
    before = after - 1
    part = ((asked - times_s[before]) / (times_s[after] - times_s[before]))[:, None]
    return np.asarray((1 - part) * weights[before] + part * weights[after])


def _recursion(keep: Array, drive: Array) -> Array:
    """Return y, (frames, n), with ``y[i] = keep[i] y[i - 1] + drive[i]``: one bidiagonal solve instead of a loop."""
    bands = np.stack([np.ones(len(keep)), np.append(-keep[1:], 0.0)])
    return np.asarray(solve_banded((1, 0), bands, drive, check_finite=False))


def _cross_talk(share: float, rng: np.random.Generator) -> Array:
    """Return a (52, 52) matrix near the identity: each shape leaks onto one other of its part of the face."""
    matrix = np.eye(len(SHAPES))
    for part in (np.flatnonzero(LOWER), np.flatnonzero(~LOWER)):
        matrix[part, rng.permutation(part)] += share * rng.random(len(part))
    return matrix


def _jitter(weights: Array, steps: Array, faults: Faults, rng: np.random.Generator) -> Array:
    """Noise with a short memory, stronger where a shape is active and in some moments than in others."""
    keep = np.exp(-steps / _JITTER_MEMORY_S)
    keep[0] = 0.0
    noise = _recursion(keep, np.sqrt(1 - keep**2)[:, None] * rng.standard_normal(weights.shape))
    knots = max(2, int(steps.sum()))
    moments = np.interp(np.cumsum(steps), np.linspace(0, steps.sum(), knots), rng.uniform(0.3, 1.0, knots))
    active = weights > 1e-4  # a tracker reports an idle shape as exactly zero
    return np.asarray(noise * moments[:, None] * (faults.jitter_rest * active + faults.jitter_active * weights))


def _spiked(weights: Array, steps: Array, faults: Faults, rng: np.random.Generator) -> Array:
    spiked = weights.copy()
    for frame in np.flatnonzero(rng.random(len(weights)) < faults.spikes_per_s * steps):
        hit = rng.choice(len(SHAPES), rng.integers(1, 9), replace=False)
        spiked[frame, hit] += rng.uniform(-1, 1, len(hit)) * faults.spike_size
    return spiked


def _stretches(steps: Array, per_s: float, lengths_s: tuple[float, ...], rng: np.random.Generator) -> Mask:
    """Return (frames,) bool: stretches that begin at random and last one of the given lengths."""
    mask = np.zeros(len(steps), bool)
    times = np.cumsum(steps)
    for frame in np.flatnonzero(rng.random(len(steps)) < per_s * steps):
        length = lengths_s[int(rng.integers(len(lengths_s)))] * rng.uniform(0.8, 1.2)
        mask[frame : np.searchsorted(times, times[frame] + length)] = True
    return mask


def changing_times(duration_s: float, rng: np.random.Generator) -> Array:
    """Return (frames,) times of a source whose rate wanders between 24 and 120 fps and whose frames come unevenly."""
    count = int(duration_s * 120) + 2
    pace = np.interp(
        np.arange(count), np.arange(0, count + 60, 60), rng.uniform(24, 120, len(range(0, count + 60, 60)))
    )
    times = np.cumsum(rng.uniform(0.8, 1.2, count) / pace)
    return np.asarray(times[times <= duration_s] - times[0])


def measure(take: Take) -> dict[str, float]:
    """Return the strengths that a take tells, by the names of `Faults`; quiet stretches tell jitter, repeats freezing."""
    kept: Mask = ~take.lost
    noise = np.diff(take.weights, n=4, axis=0) / np.sqrt(
        70
    )  # the fourth difference of white noise has 70 x its variance
    window = max(4, round(take.fps / 2))
    count = len(noise) // window
    cut = (count, window, len(SHAPES))
    level = np.sqrt((noise[: count * window].reshape(cut) ** 2).mean(axis=1))
    height = take.weights[2:-2][: count * window].reshape(cut).mean(axis=1)
    whole: Mask = np.all(kept[2:-2][: count * window].reshape(count, 1, window), axis=2)
    rest: Mask = whole & (height > 0.02) & (height < 0.1)
    active: Mask = whole & (height > 0.3)
    return {
        "jitter_rest": float(np.percentile(level[rest], 90)) if rest.any() else 0.0,
        "jitter_active": float(np.percentile((level / np.maximum(height, 1e-6))[active], 90)) if active.any() else 0.0,
        "spikes_per_s": int((leaps(take.weights, kept, least=_LEAP, quiet=None) > 0).sum()) / take.duration_s,
        "frozen_per_s": len(runs(repeats(take.weights, kept))) / take.duration_s,
        "lost_per_s": len(runs(take.lost)) / take.duration_s,
        "lost_longest_s": max((stop - start for start, stop in runs(take.lost)), default=0) / take.fps,
    }
