"""Retrieval of slow motion for long gaps without guidance, from the rest of the same take."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.ndimage import gaussian_filter1d

from engine.inpaint import seams
from engine.inpaint.seams import binomial_smooth, bridge, harmonic_frames
from engine.take import Array


@dataclass(frozen=True)
class Tuning:
    """Settings of the retrieval, in frames at the model rate; the range tried on validation takes in brackets."""

    longest_frames: int = 120  # of one retrieved piece; a longer gap takes several, each matched to the end of the last
    shortest_frames: int = 30  # without a stretch this long in the take nothing is retrieved
    candidates: int = 6  # nearest stretches among which the seed chooses
    smoothing_passes: int = 4  # [0 .. 20]; below, fills move less evenly, above, lids no longer meet
    share_frames: float = 4.0  # from both seams [4 .. 12]; the least that leaves the error at 0.5 s where it was
    fade_frames: float = 100.0  # over which the step from a seam to the retrieved motion fades [40, 100]
    # Shrinkage of the slow part to the take's mean pose in long gaps, since a match at the ends tells little of the middle.
    # NPSS falls and Frechet distances grow with it [0 .. 0.3]. Quick motion is left whole, or blinks no longer closed.
    shrinkage: float = 0.3  # share
    shrinkage_frames: float = 90.0  # gap length over which it sets in; range not recorded
    slow_frames: float = 20.0  # standard deviation of the low-pass filter; range not recorded
    context_frames: int = 8  # known frames on either side that are matched
    apart_frames: int = 15  # between stretches that count as different


TUNING = Tuning()


def retrieve(known: Array, rest: Sequence[Array], spread: Array, rank: int = 0) -> Array | None:
    """Return smooth motion through all known values, (frames, 52), along a retrieved stretch of the same take.

    The stretch is the `rank`-th nearest in squared distance to the context, pins and known shapes. None where no stretch
    is long enough.

    Parameters
    ----------
    known : (frames, 52) weights; NaN is what is to be generated
    rest : (frames, 52) each, stretches of the same take without gaps
    spread : (52,) standard deviations of the shapes; distances are in units of their square roots, between raw weights,
        where shapes that hardly move count for nothing, and standard deviations, where they count as much as the jaw
        (the best of the three on validation takes)
    """
    unit = np.sqrt(spread)
    hole = np.flatnonzero(np.isnan(known).any(axis=1))
    context = TUNING.context_frames
    longest = min(TUNING.longest_frames, max((len(piece) for piece in rest), default=0) - 2 * context)
    if not len(hole) or longest < min(TUNING.shortest_frames, len(hole)):
        return None
    first, last = max(0, int(hole[0]) - context), min(len(known), int(hole[-1]) + 1 + context)
    borders = np.linspace(first, last, int(np.ceil((hole[-1] + 1 - hole[0]) / longest)) + 1).round().astype(int)
    motion, scaled = known.copy(), [piece / unit for piece in rest]
    for start, stop in pairwise(borders):
        begin = max(first, start - context)
        query = motion[begin:stop].copy()
        stretch = unit * _nearest_stretch(query / unit, scaled, rank)
        motion[begin:stop] = _cross_fade(query, stretch, context if begin < start else 0)
    motion = _shrink(binomial_smooth(motion, TUNING.smoothing_passes), rest, hole_frames=len(hole))
    fade = np.full(len(known), 1 / (seams.TUNING.reach_frames * TUNING.fade_frames) ** 2)
    return motion + bridge(known - motion, hold=fade)


def _cross_fade(query: Array, stretch: Array, frames: int) -> Array:
    """Return a stretch, (n, 52), that sets in over its first frames from the query, (n, 52) with NaN in it."""
    fade = np.linspace(0.0, 1.0, frames + 2)[1:-1] if frames else np.ones(0)
    share = np.concatenate([fade, np.ones(len(query) - len(fade))])[:, None]
    return np.where(np.isnan(query), stretch, query + share * (stretch - query))


def _shrink(motion: Array, rest: Sequence[Array], *, hole_frames: int) -> Array:
    """Return motion, (frames, 52), whose slow part is shrunk to the take's mean pose, the more the longer the gap."""
    slow = gaussian_filter1d(motion, TUNING.slow_frames, axis=0, mode="nearest")
    share = TUNING.shrinkage * (1 - np.exp(-hole_frames / TUNING.shrinkage_frames))
    return np.asarray(motion + share * (np.concatenate(rest).mean(axis=0) - slow))


def _nearest_stretch(query: Array, rest: Sequence[Array], rank: int) -> Array:
    """Return the `rank`-th nearest stretch that does not overlap a nearer one, (frames, 52)."""
    places = [(piece, squared_distances(piece, query)) for piece in rest if len(piece) >= len(query)]
    for _ in range(rank + 1):
        piece, cost = min(places, key=lambda place: place[1].min())
        start = int(cost.argmin())
        found = piece[start : start + len(query)]
        cost[max(0, start - TUNING.apart_frames) : start + TUNING.apart_frames + 1] = np.inf
    return found


def squared_distances(take: Array, query: Array) -> Array:
    """Return the squared distance of each stretch of a take to the known part of a query, (stretches,).

    ``|a - b|^2 = |a|^2 - 2 a b + |b|^2`` row by row, so that all of it is two matrix products.
    """
    stretches = len(take) - len(query) + 1
    there = np.isfinite(query)
    rows = np.flatnonzero(there.any(axis=1))
    poses = np.where(there, query, 0.0)[rows]
    off = take**2 @ there[rows].T.astype(float) - 2 * take @ poses.T
    total = np.full(stretches, float((poses**2).sum()))
    for column, row in enumerate(rows):
        total += off[row : row + stretches, column]
    return total


def retrieval_share(known: Array) -> Array:
    """Return the share of retrieved motion in the base, (frames, 52) in 0..1: 0 at known values, 1 far from both seams.

    ``1 - exp(-(h / share_frames)^2)`` with h of `harmonic_frames`.
    """
    return np.asarray(1 - np.exp(-((harmonic_frames(known) / TUNING.share_frames) ** 2)))
