"""Removes the tracker's jitter from a capture before its velocities are matched (Whittaker smoothing)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solveh_banded

from engine.take import Array

FOURTH = np.sqrt(70.0)  # standard deviation of the fourth difference of unit white noise
MAD = 0.6745  # median of the absolute value of a standard normal variable


@dataclass(frozen=True)
class Tuning:
    """Limits of the smoothing; ranges tried were not recorded."""

    shortest_frames: int = 8  # shorter captures are returned as they are: noise and motion look alike
    strongest: float = 1e4  # largest lambda
    least_motion: float = 0.05  # share of the squared second differences that counts as motion at least


TUNING = Tuning()


def denoise(motion: Array) -> Array:
    """Smooth white noise away from displacements, (frames, n, 3) mm without gaps, marker by marker.

    Minimises ``|x - y|^2 + lambda |D2 x|^2`` with lambda the variance of the marker's noise over that of its
    acceleration (Whittaker 1923). The noise is what fourth differences show in the median frame, in which a face hardly
    moves; a marker that flies, such as a lid, is smoothed little, and a clean capture comes back as it is.
    """
    frames, markers = motion.shape[:2]
    if frames < TUNING.shortest_frames:
        return motion
    noise = (np.median(np.abs(np.diff(motion, 4, axis=0)), axis=(0, 2)) / (FOURTH * MAD)) ** 2
    roughness = (np.diff(motion, 2, axis=0) ** 2).mean(axis=(0, 2))
    moving = np.maximum(roughness - 6 * noise, TUNING.least_motion * roughness + 1e-12)
    smoothed = np.empty_like(motion)
    for marker in range(markers):
        penalty = min(float(noise[marker] / moving[marker]), TUNING.strongest)
        smoothed[:, marker] = solveh_banded(_bands(frames, penalty), motion[:, marker])
    return smoothed


def _bands(frames: int, penalty: float) -> Array:
    """Return the upper bands of ``I + penalty D2' D2``, (3, frames)."""
    second = np.array([1.0, -2.0, 1.0])
    bands = np.zeros((3, frames))
    for first in range(3):
        for later in range(first, 3):
            bands[2 - (later - first), later : frames - 2 + later] += penalty * second[first] * second[later]
    bands[2] += 1.0
    return bands
