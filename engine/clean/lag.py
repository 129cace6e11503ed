"""How far one performance is behind another."""

from __future__ import annotations

import numpy as np

from engine.take import Array

_LONGEST_S = 0.2
_ACTIVE = 0.03  # standard deviation of a weight below which a curve tells nothing of time
_GRID_FPS = 240.0


def lag_ms(late: Array, early: Array, times_s: Array) -> float:
    """Return by how much curves, (frames, n), trail others, in ms; the mean over shapes that move.

    The peak of the cross-correlation of velocities, between samples by a parabola; NaN where nothing moves.
    """
    moving = np.flatnonzero((early.std(axis=0) > _ACTIVE) & (late.std(axis=0) > _ACTIVE))
    grid = np.arange(times_s[0], times_s[-1], 1 / _GRID_FPS)
    shifts = round(_LONGEST_S * _GRID_FPS)
    if not len(moving) or len(grid) < 4 * shifts:
        return float("nan")
    lags = [
        _peak(*(np.diff(np.interp(grid, times_s, curves[:, shape])) for curves in (late, early)), shifts)
        for shape in moving
    ]
    return float(np.mean(lags)) * 1e3 / _GRID_FPS


def _peak(late: Array, early: Array, shifts: int) -> float:
    size = 1 << (2 * len(late)).bit_length()
    spectrum = np.fft.rfft(late, size) * np.conj(np.fft.rfft(early, size))
    correlation = np.fft.irfft(spectrum, size)
    around = np.concatenate([correlation[-shifts:], correlation[: shifts + 1]])
    best = int(np.clip(np.argmax(around), 1, len(around) - 2))
    left, middle, right = around[best - 1 : best + 2]
    bend = left - 2 * middle + right
    return best - shifts + (0.5 * (left - right) / bend if bend else 0.0)
