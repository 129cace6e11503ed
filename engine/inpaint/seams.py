"""Smooth interpolation of known values, and the smooth correction of generated motion onto seams and pins.

Both are one small banded solve per pattern of unknown frames, shared by all shapes with that pattern.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solveh_banded

from engine.take import Array, Mask


@dataclass(frozen=True)
class Tuning:
    """Constants of the interpolation."""

    reach_frames: float = (
        4.0  # frames at the model rate over which the slope at a seam fades; chosen on validation takes
    )
    regulariser: float = 1e-9  # pull to zero of what neither seam nor pin determines; any value this small will do


TUNING = Tuning()


def bridge(known: Array, *, reach_frames: float = TUNING.reach_frames, hold: Array | None = None) -> Array:
    """Interpolate curves, (frames, n), through all known values.

    Minimises ``sum |D2 x|^2 + |D1 x|^2 / reach^2 + hold x^2`` over the unknown values: accelerations, velocities and,
    weighted by `hold`, departure from zero. On a gap much shorter than the reach this is the cubic through both seams' values
    and slopes; on a longer one the slopes fade out into a straight line. At an end of the take the curve levels off.

    Parameters
    ----------
    known : (frames, n); NaN is interpolated
    reach_frames : frames over which the slope at a seam fades
    hold : (frames,), optional; strength of the pull to zero
    """
    curves = np.array(known, np.float64)
    for columns, unknown in _patterns(np.isnan(known)):
        curves[np.ix_(unknown, columns)] = _solve(curves[:, columns], unknown, reach_frames, hold)
    return curves


def bridge_weights(known: Array) -> Array:
    """Interpolate weights, (frames, n), and clip what is interpolated to 0..1, since slopes at seams overshoot."""
    return np.where(np.isnan(known), np.clip(bridge(known), 0.0, 1.0), known)


def constrain(
    motion: Array, known: Array, *, reach_frames: float = TUNING.reach_frames, hold: Array | None = None
) -> Array:
    """Move generated curves, (frames, n), as smoothly as possible onto every known value (NaN: free).

    The correction is `bridge` of the differences at the known values: SLS12 equation 5 with seams and pins as boundary
    conditions and accelerations beside velocities, so that slopes meet too. `hold`, (frames,), weakens the correction
    at frames whose pose must be kept, such as closed lips (the Sobolev term of SLS12 section 7.1).
    """
    return motion + bridge(known - motion, reach_frames=reach_frames, hold=hold)


def distance_frames(known: Array) -> Array:
    """Return how many frames each unknown value is from the nearest known one of its curve, 0 where known."""
    before, after = _sides(known)
    return np.minimum(before, after)


def nearest_known(known: Array) -> Array:
    """Return how many frames each frame is from where some of its unknown shapes are known, (frames,)."""
    nearest = np.where(np.isnan(known), distance_frames(known), np.inf).min(axis=1)
    return np.where(np.isfinite(nearest), nearest, 0.0)


def harmonic_frames(known: Array) -> Array:
    """Return the harmonic sum of the frames to the known values on either side, (frames, n), 0 where known.

    ``1 / (1 / before + 1 / after)``: the variance of a Brownian bridge between two known values.
    """
    before, after = _sides(known)
    return before * after / np.maximum(before + after, 1)


def _sides(known: Array) -> tuple[Array, Array]:
    """Return how many frames each value is from the known ones before and after it, far more than there are at ends."""
    frames, known_here = len(known), np.isfinite(known)
    at = np.arange(frames, dtype=np.float64)[:, None]
    before = np.maximum.accumulate(np.where(known_here, at, -2.0 * frames), axis=0)
    after = np.minimum.accumulate(np.where(known_here, at, 3.0 * frames)[::-1], axis=0)[::-1]
    return at - before, after - at


def binomial_smooth(curves: Array, passes: int) -> Array:
    """Smooth curves, (frames, n), by so many passes of the filter 1/4, 1/2, 1/4."""
    for _ in range(passes):
        padded = np.concatenate([curves[:1], curves, curves[-1:]])
        curves = (padded[:-2] + 2 * padded[1:-1] + padded[2:]) / 4
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
    bands[0] += TUNING.regulariser if hold is None else TUNING.regulariser + hold
    return bands


def _times(bands: Array, curves: Array) -> Array:
    product = bands[0][:, None] * curves
    for offset in (1, 2):
        band = bands[offset, : len(curves) - offset, None]
        product[offset:] += band * curves[:-offset]
        product[:-offset] += band * curves[offset:]
    return np.asarray(product)
