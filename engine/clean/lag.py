"""How far one performance is behind another."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from engine.take import Array

_LONGEST_S = 0.2
_ACTIVE = 0.03  # standard deviation of a weight below which a curve tells nothing of time
_GRID_FPS = 120.0


def lag_ms(late: Array, early: Array, times_s: Array) -> float:
    """Return by how much curves, (frames, n), trail others, in ms; the mean over shapes that move.

    The peak of the cross-correlation of velocities, between samples by a parabola; NaN where nothing moves.
    """
    moving = np.flatnonzero((early.std(axis=0) > _ACTIVE) & (late.std(axis=0) > _ACTIVE))
    grid = np.arange(times_s[0], times_s[-1], 1 / _GRID_FPS)
    shifts = round(_LONGEST_S * _GRID_FPS)
    if not len(moving) or len(grid) < 4 * shifts:
        return float("nan")
    # A straight line between samples would put corners into both at the same times, and hide the lag.
    behind, before = (CubicSpline(times_s, curves[:, moving])(grid, 1) for curves in (late, early))
    likeness = np.array([_likeness(behind, before, shift) for shift in range(-shifts, shifts + 1)])
    peaks = [_peak(likeness[:, shape]) - shifts for shape in range(len(moving))]
    return float(np.mean(peaks)) * 1e3 / _GRID_FPS


def _likeness(late: Array, early: Array, shift: int) -> Array:
    """Return (n,) correlations of curves, (frames, n), with one shifted; over what overlaps, lest zero look best."""
    count = len(late) - abs(shift)
    ours, theirs = late[max(0, shift) :][:count], early[max(0, -shift) :][:count]
    energy = np.sqrt(np.einsum("fs,fs->s", ours, ours) * np.einsum("fs,fs->s", theirs, theirs))
    return np.asarray(np.einsum("fs,fs->s", ours, theirs) / np.maximum(energy, 1e-12))


def _peak(likeness: Array) -> float:
    """Return where a curve is highest, between its samples by a parabola."""
    best = int(np.clip(np.argmax(likeness), 1, len(likeness) - 2))
    left, middle, right = likeness[best - 1 : best + 2]
    bend = left - 2 * middle + right
    return best + (0.5 * (left - right) / bend if bend else 0.0)
