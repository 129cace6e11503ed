"""What a tracker spoils: lost and frozen frames, spikes, jitter, pops, and jumps of the head."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

import numpy as np

from engine.quality.record import Flag, lasting, weight_of
from engine.quality.seen import Seen, strengths
from engine.quality.tuning import TUNING
from engine.take import SHAPES, Array, Mask, runs

# Gaze and lids step within a frame in any recording (saccades, blinks), and a tongue is out or in.
_STEADY = np.array([not name.startswith("eye") and name != "tongueOut" for name in SHAPES])
_WHITE = np.sqrt(70)  # the fourth difference of white noise has 70 x its variance


def lost(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield runs for which the tracker had no face."""
    for start, stop in runs(seen.lost[low:high]):
        text = f"The tracker had no face for {lasting(stop - start, seen.fps)}; the curves are guessed here."
        weight = weight_of((stop - start) / seen.fps, 0.0, seen.tuning.full_loss_s)
        yield Flag("lost", low + start, low + stop, weight, text)


def repeats(weights: Array, kept: Mask) -> Mask:
    """Return which frames, (frames,) bool, are the very frame before; only `kept` ones count."""
    same = np.zeros(len(weights), bool)
    same[1:] = kept[1:] & kept[:-1] & (weights[1:] == weights[:-1]).all(axis=1)
    return same


def least_repeats(seen: Seen) -> int:
    """Return how many frames like the one before make a freeze."""
    return max(2, math.ceil(seen.tuning.least_freeze_s * seen.fps - 1e-6))


def frozen(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield runs of frames like the one before; a face with every shape at zero rests, it is not frozen."""

    def verdict(weights: Array, kept: Mask) -> Array:
        same: Mask = repeats(weights, kept)
        at = np.flatnonzero(same)
        same[at] = weights[at].any(axis=1)
        return np.asarray(same, float)

    least = least_repeats(seen)
    for start, stop in runs(strengths(seen, low, high, reach=1, verdict=verdict) > 0):
        if stop - start >= least:
            text = f"The face does not move at all for {lasting(stop - start + 1, seen.fps)}."
            weight = weight_of((stop - start) / seen.fps, 0.0, seen.tuning.full_freeze_s)
            yield Flag("frozen", low + start, low + stop, weight, text)


def leaps(
    weights: Array,
    kept: Mask,
    *,
    least: float = TUNING.leap,
    quiet: float | None = TUNING.leap_quiet,
    returns: float = TUNING.returns,
) -> Array:
    """Return how far the shape that leaps furthest for a single frame does, (frames,); 0 where none leaps and returns.

    A peak of three frames is an articulation: on the frames beside a leap the shape moves by far less than the leap.

    Parameters
    ----------
    least : weight; smaller leaps are none
    quiet : share of the leap by which the shape may move on the frames beside it; None lets it move
    returns : weight; farther from where it was it has not come back
    """
    found = np.zeros(len(weights))
    if len(weights) < 3:
        return found
    before, now, after = weights[:-2], weights[1:-1], weights[2:]
    leap = np.abs(now - (after + before) / 2)
    leap[(leap <= least) | (np.abs(after - before) >= returns)] = 0.0
    for at in np.flatnonzero(leap.any(axis=1)) if quiet is not None else ():  # few
        earlier, later = weights[max(0, int(at) - 1)], weights[min(len(weights) - 1, int(at) + 3)]
        beside = np.maximum(np.abs(before[at] - earlier), np.abs(later - after[at]))
        leap[at, beside > quiet * leap[at]] = 0.0
    found[1:-1] = leap.max(axis=1) * (kept[:-2] & kept[1:-1] & kept[2:])
    return found


def spikes(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield frames on which a shape leaps and comes back."""
    tuning = seen.tuning
    verdict_of = partial(leaps, least=tuning.leap, quiet=tuning.leap_quiet, returns=tuning.returns)
    leap = strengths(seen, low, high, reach=2, verdict=verdict_of)
    for start, stop in runs(leap > 0):
        furthest = float(leap[start:stop].max())
        text = f"A shape leaps by {furthest:.2f} for a single frame and comes back."
        yield Flag("spike", low + start, low + stop, weight_of(furthest, seen.tuning.leap, seen.tuning.full_leap), text)


def pops(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield steps of a shape between two stretches on which it hardly moves."""
    beside = max(2, round(seen.tuning.pop_beside_s * seen.fps))

    def verdict(weights: Array, kept: Mask) -> Array:
        found = np.zeros(len(weights))
        step = np.abs(np.diff(weights, axis=0, prepend=weights[:1]))  # of a frame from the one before
        step[:, ~_STEADY] = 0.0
        for at in np.flatnonzero((step > seen.tuning.pop).any(axis=1)):
            first, last = at - beside, at + beside + 1
            if first < 1 or last > len(weights) or not kept[first - 1 : last].all():
                continue
            near = np.maximum(step[first:at].max(axis=0), step[at + 1 : last].max(axis=0))
            popped = (step[at] > seen.tuning.pop) & (near < seen.tuning.pop_quiet * step[at])
            found[at] = step[at][popped].max(initial=0.0)
        return found

    step = strengths(seen, low, high, reach=beside + 2, verdict=verdict)
    for start, stop in runs(step > 0):
        furthest = float(step[start:stop].max())
        text = f"A shape steps by {furthest:.2f} from one frame to the next and stays there."
        yield Flag("pop", low + start, low + stop, weight_of(furthest, seen.tuning.pop, seen.tuning.full_pop), text)


def jitter_block(seen: Seen) -> int:
    """Return the frames of a stretch that is judged as one."""
    return max(6, round(seen.tuning.jitter_s * seen.fps))


def jitter(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield stretches in which a shape trembles from frame to frame more than it moves.

    With d4 and d1 the fourth and first difference, each divided by what it is for white noise of deviation 1, a shape
    trembles where |d4| is above the threshold on most frames and the mean |d4| is a large share of the mean |d1|.
    """
    size = jitter_block(seen)
    first, last = low // size, min(-(-high // size), seen.length // size)
    level = np.zeros(max(0, last - first))
    for begin in range(first, last, 64):
        end = min(last, begin + 64)
        level[begin - first : end - first] = _trembling(seen, begin, end, size)
    frames = np.repeat(level, size)[low - first * size :][: high - low]
    for start, stop in runs(frames > 0):
        worst = float(frames[start:stop].max())
        text = f"A shape trembles by {worst:.3f} from frame to frame for {lasting(stop - start, seen.fps)}."
        yield Flag(
            "jitter", low + start, low + stop, weight_of(worst, seen.tuning.jitter, seen.tuning.full_jitter), text
        )


def _trembling(seen: Seen, begin: int, end: int, size: int) -> Array:
    """Return the deviation of the shape that trembles most in each stretch begin to end, 0 where none does."""
    start, stop = begin * size, end * size
    first, last = max(0, start - 2), min(seen.length, stop + 2)
    rows = seen.weights[first:last]
    rough = np.zeros((stop - start, rows.shape[1]))
    fourth = np.diff(rows, n=4, axis=0)
    at = first + 2 - start
    rough[at : at + len(fourth)] = np.abs(fourth, out=fourth)
    blocks = rough.reshape(end - begin, size, -1)
    many: Mask = np.asarray((blocks > seen.tuning.jitter * _WHITE).sum(axis=1) >= seen.tuning.jitter_share * size)
    whole: Mask = np.asarray(seen.kept[start:stop].reshape(end - begin, size).all(axis=1))
    many &= whole[:, None]
    found = np.zeros(end - begin)
    for block in np.flatnonzero(many.any(axis=1)):
        here = seen.weights[start + block * size : start + (block + 1) * size]
        noise = blocks[block].mean(axis=0) / _WHITE
        motion = np.abs(np.diff(here, axis=0)).mean(axis=0) / np.sqrt(2)
        trembles = many[block] & (noise > seen.tuning.jitter_ratio * motion)
        # the mean of |x| is 0.8 deviations of x
        found[block] = (noise[trembles] / 0.8).max(initial=0.0)
    return found


def head(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield frames on which the head turns by far more than on the frames beside it."""
    if seen.rotations is None:
        return
    first, last = max(0, low - 3), min(seen.length, high + 3)
    turn = np.degrees(np.diff(seen.rotations[first:last], axis=0))  # (n - 1, 3)
    turn = (turn + 180.0) % 360.0 - 180.0
    found = np.zeros(last - first)
    if len(turn) >= 3:
        before, now, after = turn[:-2], turn[1:-1], turn[2:]
        # beyond both turns beside it: a head that turns fast does so for several frames
        beyond = np.maximum(now - np.maximum(before, after), np.minimum(before, after) - now)
        kept = seen.kept[first:last]
        found[2:-1] = beyond.max(axis=1) * (kept[:-3] & kept[1:-2] & kept[2:-1] & kept[3:])
    found = found[low - first : high - first]
    for start, stop in runs(found > seen.tuning.jump_deg):
        furthest = float(found[start:stop].max())
        text = f"The head jumps by {furthest:.0f} degrees from one frame to the next."
        yield Flag(
            "head", low + start, low + stop, weight_of(furthest, seen.tuning.jump_deg, seen.tuning.full_jump_deg), text
        )
