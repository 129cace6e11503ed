"""Smooth curves through what is known: the motion under a fill, and the correction that lands it on seams and pins.

Both are one small banded solve per pattern of unknown frames, shared by all shapes with that pattern.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.linalg import solveh_banded

from engine.take import Array, Mask

REACH_FRAMES = 4.0  # how far, at the model rate, the slope at a seam is felt; chosen on validation takes
_PULL = 1e-9  # holds what neither seam nor pin determines


def bridge(known: Array, *, reach_frames: float = REACH_FRAMES, hold: Array | None = None) -> Array:
    """Return curves, (frames, n), through all known values, with NaN in `known` replaced.

    Minimises ``sum |D2 x|^2 + |D1 x|^2 / reach^2 + hold x^2`` over the unknown values: accelerations, velocities and,
    where asked, departure from zero. On a gap much shorter than the reach this is the cubic through both seams' values
    and slopes; on a longer one the slopes fade out into a straight line. At an end of the take the curve levels off.

    Parameters
    ----------
    known : (frames, n); NaN marks what to make
    reach_frames : how far the slope at a seam is felt
    hold : (frames,), optional; how much the curve is kept at zero there
    """
    made = np.array(known, np.float64)
    for columns, unknown in _patterns(np.isnan(known)):
        made[np.ix_(unknown, columns)] = _solve(made[:, columns], unknown, reach_frames, hold)
    return made


def land(made: Array, known: Array, *, reach_frames: float = REACH_FRAMES, hold: Array | None = None) -> Array:
    """Return generated curves, (frames, n), moved as smoothly as possible onto every known value (NaN: free).

    The correction is `bridge` of what is missing at the known values: SLS12 equation 5 with seams and pins as boundary
    conditions and accelerations beside velocities, so that slopes meet too. `hold`, (frames,), keeps the correction
    away from frames whose pose must survive, such as closed lips (the Sobolev term of SLS12 section 7.1).
    """
    return made + bridge(known - made, reach_frames=reach_frames, hold=hold)


def distance_frames(known: Array) -> Array:
    """Return how many frames each unknown value is from the nearest known one of its curve, 0 where known."""
    before, after = _sides(known)
    return np.minimum(before, after)


def room_frames(known: Array) -> Array:
    """Return the harmonic sum of the frames to the known values on either side of its curve, 0 where known.

    ``1 / (1 / before + 1 / after)``: how far a random walk strays between two values that it must meet.
    """
    before, after = _sides(known)
    return before * after / np.maximum(before + after, 1)


def _sides(known: Array) -> tuple[Array, Array]:
    """Return how many frames each value is from the known ones before and after it, far more than there are at ends."""
    frames, there = len(known), np.isfinite(known)
    at = np.arange(frames, dtype=np.float64)[:, None]
    before = np.maximum.accumulate(np.where(there, at, -2.0 * frames), axis=0)
    after = np.minimum.accumulate(np.where(there, at, 3.0 * frames)[::-1], axis=0)[::-1]
    return at - before, after - at


def smoothed(curves: Array, passes: int) -> Array:
    """Return curves, (frames, n), after so many passes of the filter 1/4, 1/2, 1/4."""
    for _ in range(passes):
        held = np.concatenate([curves[:1], curves, curves[-1:]])
        curves = (held[:-2] + 2 * held[1:-1] + held[2:]) / 4
    return curves


def _patterns(unknown: Mask) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield columns that share a pattern of unknown rows, with those rows."""
    columns: dict[bytes, list[int]] = {}
    rows = np.ascontiguousarray(unknown.T)
    for column, pattern in enumerate(rows):
        columns.setdefault(pattern.tobytes(), []).append(column)
    for alike in columns.values():
        if rows[alike[0]].any():
            yield np.array(alike), np.flatnonzero(rows[alike[0]])


def _solve(curves: Array, unknown: np.ndarray, reach_frames: float, hold: Array | None) -> Array:
    bands = _bands(len(curves), reach_frames, hold)
    known = curves.copy()
    known[unknown] = 0.0
    pull = -_times(bands, known)[unknown]
    near = np.zeros((3, len(unknown)))
    near[0] = bands[0, unknown]
    for step in (1, 2):
        gap = unknown[step:] - unknown[:-step]
        near[step, : len(gap)] = np.where(gap <= 2, bands[np.minimum(gap, 2), unknown[: len(gap)]], 0.0)
    return np.asarray(solveh_banded(near, pull, lower=True, check_finite=False))


def _bands(frames: int, reach_frames: float, hold: Array | None) -> Array:
    """Return the three lower bands, (3, frames), of the symmetric matrix of the quadratic form."""
    bands = np.zeros((3, frames))
    for stencil, weight in ((np.array([1.0, -1.0]), reach_frames**-2.0), (np.array([1.0, -2.0, 1.0]), 1.0)):
        rows = frames - len(stencil) + 1
        if rows <= 0:
            continue
        for offset in range(len(stencil)):
            for first in range(len(stencil) - offset):
                bands[offset, first : first + rows] += weight * stencil[first] * stencil[first + offset]
    bands[0] += _PULL if hold is None else _PULL + hold
    return bands


def _times(bands: Array, curves: Array) -> Array:
    product = bands[0][:, None] * curves
    for offset in (1, 2):
        band = bands[offset, : len(curves) - offset, None]
        product[offset:] += band * curves[:-offset]
        product[:-offset] += band * curves[offset:]
    return np.asarray(product)
