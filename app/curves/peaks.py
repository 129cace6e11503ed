"""Curves thinned to what a screen can show, so that drawing an hour costs as much as drawing a second."""

from __future__ import annotations

import numpy as np

from engine.take import Array


def on_screen(frames: int, view: tuple[float, float]) -> tuple[int, int]:
    """Return the half-open range of frames that a view shows, with one more on either side so that lines reach its edge."""
    return max(0, int(view[0]) - 1), min(frames, int(np.ceil(view[1])) + 2)


def peaks(visible: Array, start: int, columns: int) -> tuple[Array, Array]:
    """Return frames and values that draw visible, (n,) from frame `start`, on `columns` pixels.

    Where more than two frames fall on a pixel, only the lowest and highest value of each are kept, so no spike is lost.
    """
    if len(visible) == 1:  # all of a take of one frame: a line needs two points
        return np.array([start, start + 1.0]), np.repeat(visible, 2)
    step = len(visible) // max(1, columns)
    if step < 3:
        return np.arange(start, start + len(visible), dtype=np.float64), visible
    # bins begin on multiples of the step, or they would shimmer while panning
    edges = np.arange(start // step * step, start + len(visible), step)
    offsets = np.maximum(edges - start, 0)
    low, high = np.minimum.reduceat(visible, offsets), np.maximum.reduceat(visible, offsets)
    return np.repeat(edges + step / 2, 2), np.stack([low, high], axis=1).ravel()
