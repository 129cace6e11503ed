"""Taking a tracker's jitter out of a capture before its velocities are matched, as far as the capture shows any."""

from __future__ import annotations

import numpy as np
from scipy.linalg import solveh_banded

from engine.take import Array

SHORTEST = 8  # frames; fewer do not tell noise from motion
FOURTH = np.sqrt(70.0)  # standard deviation of the fourth difference of white noise of one
MAD = 0.6745  # median of the absolute value of a normal variable of one
STRONGEST = 1e4


def denoise(motion: Array) -> Array:
    """Return displacements, (frames, n, 3) mm and without gaps, with white noise smoothed away, marker by marker.

    Minimises ``|x - y|^2 + lambda |D2 x|^2`` with lambda the variance of the marker's noise over that of its
    acceleration (Whittaker 1923). The noise is what fourth differences show in the median frame, in which a face hardly
    moves; a marker that flies, such as a lid, is smoothed little, and a clean capture comes back as it is.
    """
    frames, markers = motion.shape[:2]
    if frames < SHORTEST:
        return motion
    noise = (np.median(np.abs(np.diff(motion, 4, axis=0)), axis=(0, 2)) / (FOURTH * MAD)) ** 2
    shaking = (np.diff(motion, 2, axis=0) ** 2).mean(axis=(0, 2))
    moving = np.maximum(shaking - 6 * noise, 0.05 * shaking + 1e-12)
    smoothed = np.empty_like(motion)
    for marker in range(markers):
        penalty = min(float(noise[marker] / moving[marker]), STRONGEST)
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
