"""Slow motion for long unguided holes, lent by the rest of the take: what this face does, as it was seen to do it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.ndimage import gaussian_filter1d

from engine.inpaint.seams import REACH_FRAMES, bridge, room_frames, smoothed
from engine.take import Array

LONGEST = 120  # frames lent in one piece; longer holes take several, each beginning as the one before it ends
SHORTEST = 30  # frames; where no stretch of the take is as long there is nothing to lend
LENDERS = 6  # so many stretches differ by the seed
SMOOTHING = 4  # passes; of 0 ... 20 on validation takes: below, fills move less evenly, above, lids no longer meet
# How far from what is known the lent motion counts, between both seams; of 4 ... 12 on validation takes the least that
# leaves the error at half a second where it was.
WAY_FRAMES = 4.0
# How slowly the step from a seam onto the lent motion fades; of 40 and 100 on validation takes.
FADE_FRAMES = 100.0
# How far the slow part of lent motion draws in to the take's mean face, and in how long a hole it does: what a stretch that
# fits at its ends tells of the middle fades. On validation takes NPSS falls and Frechet distances grow with it (of 0 ... 0.3).
# Quick motion is left whole: with it drawn in, blinks no longer closed.
DRAW_IN, DRAW_IN_FRAMES, SLOW_FRAMES = 0.3, 90.0, 20.0
_AROUND = 8  # known frames on either side by which a stretch is chosen
_APART = 15  # frames between stretches that count as different


def lent(known: Array, rest: Sequence[Array], spread: Array, rank: int = 0) -> Array | None:
    """Return smooth motion through all that is known, (frames, 52), along stretches of the rest of the take.

    The stretch is the `rank`-th nearest to the frames around the hole, to pins and to shapes that are known. None where
    no stretch is long enough.

    Parameters
    ----------
    known : (frames, 52) weights; NaN is what is to be made
    rest : (frames, 52) each, stretches of the same take without holes
    spread : (52,) of the shapes; distances are in units of its root, between raw weights, where shapes that hardly move
        count for nothing, and spreads, where they count as much as the jaw (of the three on validation takes)
    """
    unit = np.sqrt(spread)
    hole = np.flatnonzero(np.isnan(known).any(axis=1))
    longest = min(LONGEST, max((len(one) for one in rest), default=0) - 2 * _AROUND)
    if not len(hole) or longest < min(SHORTEST, len(hole)):
        return None
    first, last = max(0, int(hole[0]) - _AROUND), min(len(known), int(hole[-1]) + 1 + _AROUND)
    borders = np.linspace(first, last, int(np.ceil((hole[-1] + 1 - hole[0]) / longest)) + 1).round().astype(int)
    motion, scaled = known.copy(), [one / unit for one in rest]
    for start, stop in pairwise(borders):
        begin = max(first, start - _AROUND)
        wanted = motion[begin:stop].copy()
        stretch = unit * _stretch(wanted / unit, scaled, rank)
        fade = np.linspace(0.0, 1.0, _AROUND + 2)[1:-1] if begin < start else np.ones(0)
        share = np.concatenate([fade, np.ones(stop - begin - len(fade))])[:, None]
        motion[begin:stop] = np.where(np.isnan(wanted), stretch, wanted + share * (stretch - wanted))
    motion = smoothed(motion, SMOOTHING)
    slow = gaussian_filter1d(motion, SLOW_FRAMES, axis=0, mode="nearest")
    motion += DRAW_IN * (1 - np.exp(-len(hole) / DRAW_IN_FRAMES)) * (np.concatenate(rest).mean(axis=0) - slow)
    fading = np.full(len(known), 1 / (REACH_FRAMES * FADE_FRAMES) ** 2)
    return motion + bridge(known - motion, hold=fading)


def _stretch(wanted: Array, rest: Sequence[Array], rank: int) -> Array:
    """Return the `rank`-th nearest stretch that is not beside a nearer one, (frames, 52)."""
    places = [(one, costs(one, wanted)) for one in rest if len(one) >= len(wanted)]
    for _ in range(rank + 1):
        one, cost = min(places, key=lambda place: place[1].min())
        start = int(cost.argmin())
        found = one[start : start + len(wanted)]
        cost[max(0, start - _APART) : start + _APART + 1] = np.inf
    return found


def costs(take: Array, wanted: Array) -> Array:
    """Return the squared distance of each stretch of a take to the known part of what is wanted, (stretches,).

    ``|a - b|^2 = |a|^2 - 2 a b + |b|^2`` row by row, so that all of it is two products of matrices.
    """
    stretches = len(take) - len(wanted) + 1
    there = np.isfinite(wanted)
    rows = np.flatnonzero(there.any(axis=1))
    faces = np.where(there, wanted, 0.0)[rows]
    off = take**2 @ there[rows].T.astype(float) - 2 * take @ faces.T
    total = np.full(stretches, float((faces**2).sum()))
    for column, row in enumerate(rows):
        total += off[row : row + stretches, column]
    return total


def trust(known: Array) -> Array:
    """Return how much lent motion counts, (frames, 52) in 0..1: not beside what is known, and all far from both seams."""
    return np.asarray(1 - np.exp(-((room_frames(known) / WAY_FRAMES) ** 2)))
