"""Curves thinned to what a screen can show, so that drawing an hour costs as much as drawing a second."""

from __future__ import annotations

from functools import reduce

import numpy as np

from engine.take import Array

Rows = tuple[Array, int]  # values, (n,), and the frame of the first
BLOCK = 8  # frames whose lowest and highest values are kept


def on_screen(frames: int, view: tuple[float, float]) -> tuple[int, int]:
    """Return the half-open range of frames that a view shows, with one more on either side so that lines reach its edge."""
    return max(0, int(view[0]) - 1), min(frames, int(np.ceil(view[1])) + 2)


def peaks(visible: Array, start: int, columns: int) -> tuple[Array, Array]:
    """Return frames and values that draw visible, (n,) from frame `start`, on `columns` pixels.

    Where more than two frames fall on a pixel, only the lowest and highest value of each are kept, so no spike is lost.
    NaN is drawn only where a pixel has nothing else.
    """
    if len(visible) == 1:  # all of a take of one frame: a line needs two points
        return np.array([start, start + 1.0]), np.repeat(visible, 2)
    step = len(visible) // max(1, columns)
    if step < 3:
        return np.arange(start, start + len(visible), dtype=np.float64), visible
    return _extremes(visible, visible, start, step)


def _extremes(lowest: Array, highest: Array, start: int, step: int) -> tuple[Array, Array]:
    # bins begin on multiples of the step, or they would shimmer while panning
    edges = np.arange(start // step * step, start + len(lowest), step)
    offsets = np.maximum(edges - start, 0)
    values = np.empty((len(edges), 2))
    np.fmin.reduceat(lowest, offsets, out=values[:, 0])
    np.fmax.reduceat(highest, offsets, out=values[:, 1])
    return np.repeat(edges + step / 2, 2), values.ravel()


class Thinned:
    """A curve whose lowest and highest values in blocks of frames are kept, from when they are first needed.

    Parameters
    ----------
    curve : (frames,), not written to while this stands for it
    """

    def __init__(self, curve: Array) -> None:
        self._curve = curve
        self._blocks: tuple[Array, Array] | None = None

    def copy(self) -> Thinned:
        """Return a copy for the same curve, without counting its blocks again."""
        twin = Thinned(self._curve)
        twin._blocks = self._kept()
        return twin

    def stands_for(self, curve: Array) -> bool:
        """Return whether these are the peaks of the very same array in memory."""
        return curve.shape == self._curve.shape and curve.__array_interface__ == self._curve.__array_interface__

    @property
    def range(self) -> tuple[float, float]:
        """The lowest and the highest value; NaN where there is none."""
        lowest, highest = self._kept()
        return float(np.fmin.reduce(lowest)), float(np.fmax.reduce(highest))

    def changed_to(self, curve: Array, rows: tuple[int, int]) -> None:
        """Stand for a curve of the same length that differs in a half-open range of frames at most."""
        self._curve = curve
        if self._blocks is not None:
            self._blocks = self._blocks_with(curve[slice(*rows)], rows[0])

    def peaks(self, start: int, stop: int, columns: int, draft: Rows | None = None) -> tuple[Array, Array]:
        """Return frames and values that draw the half-open range of frames on `columns` pixels, as `peaks` does.

        Where many frames fall on a pixel, they are counted in whole blocks. A draft stands in place of the rows from
        its frame.
        """
        step = (stop - start) // max(1, columns) // BLOCK
        if step < 2:
            visible = self._curve[start:stop]
            return peaks(visible if draft is None else overlaid(visible, start, *draft), start, columns)
        lowest, highest = self._kept() if draft is None else self._blocks_with(*draft)
        shown = slice(start // BLOCK, -(-stop // BLOCK))
        blocks, values = _extremes(lowest[shown], highest[shown], shown.start, step)
        return np.minimum(BLOCK * blocks, len(self._curve) - 1.0), values

    def _kept(self) -> tuple[Array, Array]:
        if self._blocks is None:
            self._blocks = _blocks(self._curve)
        return self._blocks

    def _blocks_with(self, rows: Array, start: int) -> tuple[Array, Array]:
        lowest, highest = (kept.copy() for kept in self._kept())
        first, last = start // BLOCK, -(-(start + len(rows)) // BLOCK)
        changed = overlaid(self._curve[first * BLOCK : last * BLOCK], first * BLOCK, rows, start)
        lowest[first:last], highest[first:last] = _blocks(changed)
        return lowest, highest


def overlaid(visible: Array, start: int, rows: Array, rows_start: int) -> Array:
    """Return visible, (n,) from frame `start`, with rows from `rows_start` over it."""
    first, last = max(start, rows_start), min(start + len(visible), rows_start + len(rows))
    if first >= last:
        return visible
    merged = visible.copy()
    merged[first - start : last - start] = rows[first - rows_start : last - rows_start]
    return merged


def _blocks(curve: Array) -> tuple[Array, Array]:
    whole = np.append(curve, curve[-1:].repeat(-len(curve) % BLOCK))
    in_turn = whole.reshape(-1, BLOCK).T  # the first frames of all blocks, the second ones, and so on
    return reduce(np.fmin, in_turn), reduce(np.fmax, in_turn)
