"""The filters that cleaning is measured against: what signal processing offers, each as good as tuning makes it.

All take what a tracker delivered and return weights, (frames, 52). Gaussian and Savitzky-Golay look ahead, which a live
stream cannot; the others do not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.signal import savgol_filter

from engine.lab.performer.degrade import Tracked
from engine.take import Array

Filter = Callable[[Tracked, Array], Array]  # what was tracked, and the time of each frame in seconds


def raw(tracked: Tracked, times_s: Array) -> Array:
    """Return what the tracker delivered; a lost frame repeats the one before."""
    return tracked.weights


def exponential(share: float) -> Filter:
    """Return ``y[n] = share x[n] + (1 - share) y[n - 1]`` (BSS20b section 4.3)."""

    def apply(tracked: Tracked, times_s: Array) -> Array:
        result = tracked.weights.copy()
        for index in range(1, len(result)):
            result[index] = share * result[index] + (1 - share) * result[index - 1]
        return result

    return apply


def gaussian(sigma_frames: float) -> Filter:
    """Return convolution with a Gaussian window; looks ahead (BSS20b section 4.3)."""

    def apply(tracked: Tracked, times_s: Array) -> Array:
        return np.asarray(gaussian_filter1d(tracked.weights, sigma_frames, axis=0, mode="nearest"))

    return apply


def savgol(window_frames: int, order: int) -> Filter:
    """Return the Savitzky-Golay filter; looks ahead by half its window."""

    def apply(tracked: Tracked, times_s: Array) -> Array:
        window = min(window_frames, (len(tracked.weights) - 1) | 1)
        if window <= order:
            return tracked.weights
        return np.asarray(savgol_filter(tracked.weights, window, order, axis=0))

    return apply


@dataclass(frozen=True)
class OneEuro:
    """The One Euro filter (Casiez, Roussel, Vogel 2012): a low-pass whose cutoff rises with speed.

    Attributes
    ----------
    cutoff_hz : at rest
    beta : how much a speed of one weight per second adds to the cutoff, Hz
    """

    cutoff_hz: float
    beta: float
    speed_cutoff_hz: float = 1.0

    def __call__(self, tracked: Tracked, times_s: Array) -> Array:
        """Filter."""
        result = tracked.weights.copy()
        speed = np.zeros(result.shape[1])
        for index, step in enumerate(np.diff(times_s), start=1):
            change = (tracked.weights[index] - tracked.weights[index - 1]) / step
            speed += _share(self.speed_cutoff_hz, step) * (change - speed)
            share = _share(self.cutoff_hz + self.beta * np.abs(speed), step)
            result[index] = result[index - 1] + share * (tracked.weights[index] - result[index - 1])
        return result


def _share(cutoff_hz: float | Array, step_s: float) -> Array:
    return np.asarray(1 / (1 + 1 / (2 * np.pi * np.asarray(cutoff_hz) * step_s)))


@dataclass(frozen=True)
class Kalman:
    """A Kalman filter of position and velocity for each shape; on a lost frame it predicts.

    Attributes
    ----------
    acceleration : spectral density of the driving noise, weight^2 / s^3
    noise : variance of what the tracker says, weight^2
    """

    acceleration: float
    noise: float = 1e-3

    def __call__(self, tracked: Tracked, times_s: Array) -> Array:
        """Filter; all shapes share one covariance, since they share its parameters."""
        result = tracked.weights.copy()
        state = np.stack([result[0], np.zeros_like(result[0])])
        covariance = np.diag([self.noise, 1.0])
        for index, step in enumerate(np.diff(times_s), start=1):
            move = np.array([[1.0, step], [0.0, 1.0]])
            driven = self.acceleration * np.array([[step**3 / 3, step**2 / 2], [step**2 / 2, step]])
            state, covariance = move @ state, move @ covariance @ move.T + driven
            if not tracked.lost[index]:
                gain = covariance[:, 0] / (covariance[0, 0] + self.noise)
                state = state + np.outer(gain, tracked.weights[index] - state[0])
                covariance = covariance - np.outer(gain, covariance[0])
            state[0] = np.clip(state[0], 0.0, 1.0)
            result[index] = state[0]
        return result
