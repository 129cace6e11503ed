"""The lag between two performances, by cross-correlation of their velocities."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from engine.take import Array


@dataclass(frozen=True)
class Tuning:
    """Settings of the measurement; ranges tried were not recorded."""

    longest_s: float = 0.2  # seconds, the largest lag that is searched
    active: float = 0.03  # weight; shapes with a smaller standard deviation are left out
    grid_fps: float = 120.0  # frames per second of the resampled curves


TUNING = Tuning()


def lag_ms(late: Array, early: Array, times_s: Array) -> float:
    """Return the lag of curves, (frames, n), behind others in ms, as the mean over shapes that move.

    The peak of the cross-correlation of velocities, between samples by a parabola; NaN where nothing moves.
    """
    moving = np.flatnonzero((early.std(axis=0) > TUNING.active) & (late.std(axis=0) > TUNING.active))
    grid = np.arange(times_s[0], times_s[-1], 1 / TUNING.grid_fps)
    shifts = round(TUNING.longest_s * TUNING.grid_fps)
    if not len(moving) or len(grid) < 4 * shifts:
        return float("nan")
    # A straight line between samples would put corners into both at the same times, and hide the lag.
    trailing, leading = (CubicSpline(times_s, curves[:, moving])(grid, 1) for curves in (late, early))
    correlation = np.array([_correlation(trailing, leading, shift) for shift in range(-shifts, shifts + 1)])
    peaks = [_peak(correlation[:, shape]) - shifts for shape in range(len(moving))]
    return float(np.mean(peaks)) * 1e3 / TUNING.grid_fps


def _correlation(late: Array, early: Array, shift: int) -> Array:
    """Return (n,) correlations of curves, (frames, n), with one shifted, normalised over the overlap, or zero would look best."""
    count = len(late) - abs(shift)
    first, second = late[max(0, shift) :][:count], early[max(0, -shift) :][:count]
    energy = np.sqrt(np.einsum("fs,fs->s", first, first) * np.einsum("fs,fs->s", second, second))
    return np.asarray(np.einsum("fs,fs->s", first, second) / np.maximum(energy, 1e-12))


def _peak(correlation: Array) -> float:
    """Return the position of a curve's maximum, between its samples by a parabola."""
    best = int(np.clip(np.argmax(correlation), 1, len(correlation) - 2))
    left, middle, right = correlation[best - 1 : best + 2]
    curvature = left - 2 * middle + right
    return best + (0.5 * (left - right) / curvature if curvature else 0.0)
