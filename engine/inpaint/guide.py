"""Following a guide: interpolation of the context plus the Wiener-filtered difference to a rough performance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from engine.inpaint.gap import Gap
from engine.inpaint.seams import binomial_smooth, bridge_weights, harmonic_frames
from engine.inpaint.statistics import Statistics
from engine.take import Array, Mask


@dataclass(frozen=True)
class Tuning:
    """How a guide is followed; the range tried on validation takes in brackets."""

    smoothing_passes: int = 2  # of the filter 1/4, 1/2, 1/4 over the guide [2 .. 10]
    guide_frames: float = (
        1.6  # frames from known ones at which guide and interpolation count alike; chosen on validation takes
    )
    room_frames: float = 2.0  # frames [1 .. 4]; between seams nearer than this a face has no time to follow a guide
    # Error model of a guide, against which its difference from the interpolation is weighed.
    jitter: float = 1.25  # standard deviations of its measured jitter
    gain: float = 0.2  # share of its level, for a wrong gain
    least: float = 0.005  # weight, error of every guide
    gain_of_filter: float = 1.2  # of the filter's answer; makes up for the power lost to smoothing
    window_frames: float = 4.0  # frames, standard deviation of the window for jitter, power and level


TUNING = Tuning()


def along_guide(gap: Gap, distance: Array, statistics: Statistics) -> Array:
    """Return weights, (frames, 52), that interpolate all known values and follow the guide without its jitter.

    ``p + h s (g - p)``: interpolation p, guide g, share s = d^2 / (d^2 + guide_frames^2) of the frames d to known
    values, Wiener gain h. Shapes of which nothing is known take their mean; without a guide p is returned.

    Parameters
    ----------
    distance : (frames, 52), `distance_frames` of the known values
    """
    plain = np.where(np.isnan(gap.known).all(axis=0), statistics.mean, bridge_weights(gap.known))
    guided: Mask = np.isnan(gap.known) & np.isfinite(gap.guide)
    if not guided.any():
        return plain
    guide = np.where(guided, gap.guide, plain)
    share = distance**2 / (distance**2 + TUNING.guide_frames**2)
    away = share * binomial_smooth(guide - plain, TUNING.smoothing_passes)
    room = harmonic_frames(gap.known)
    return plain + _wiener_gain(away * room / (room + TUNING.room_frames), guide, guided) * away


def _wiener_gain(away: Array, guide: Array, guided: Mask) -> Array:
    """Return the Wiener filter's gain, (frames, 52) in 0..1, for the difference `away` from the interpolation.

    ``P / (P + N)`` with powers measured around each frame: P of the difference, N of the guide's error (its jitter, a
    wrong gain, a floor). Followed everywhere alike, still shapes shook, which cost a third of the error.
    """
    jitter, inside = np.zeros_like(guide), np.zeros_like(guided)
    jitter[1:-1] = np.diff(guide, n=2, axis=0) ** 2 / 6  # white noise of variance v has 6 v in its second differences
    inside[1:-1] = guided[:-2] & guided[1:-1] & guided[2:]
    power, level = _windowed_mean(away**2, guided), _windowed_mean(guide, guided)
    noise = TUNING.jitter**2 * _windowed_mean(jitter, inside) + (TUNING.gain * level) ** 2 + TUNING.least**2
    return np.asarray(np.minimum(1.0, TUNING.gain_of_filter * power / (power + noise)))


def _windowed_mean(values: Array, inside: Mask) -> Array:
    """Return the Gaussian-weighted mean around each frame of the values that are inside, (frames, n)."""
    blurred = (
        gaussian_filter1d(x, TUNING.window_frames, axis=0, mode="constant")
        for x in (values * inside, inside.astype(float))
    )
    total, count = blurred
    return np.asarray(total / np.maximum(count, 1e-6))
