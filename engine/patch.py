"""The result of an edit: new weights for a range of frames."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engine.errors import EditError
from engine.extended import bundled_face
from engine.take import Array, Mask, Take
from engine.words import counted


@dataclass(frozen=True, eq=False)
class Patch:
    """New weights for a range of frames; everything outside stays as it is, bit for bit, but for lost frames beside it.

    Attributes
    ----------
    start : first frame
    weights : (frames, 52)
    asked : (frames, 16) control targets, NaN for none
    reached : (frames, 16) controls of the new weights
    granted : (frames, 16) targets within the plausibility limit; None where there was no target
    lost : (frames,) bool, the frames that are lost from now on; None leaves it to `Take.with_rows`
    lag_ms : of cleaning, lag behind the recorded frames at full strength; NaN where nothing moves
    """

    start: int
    weights: Array
    asked: Array
    reached: Array
    granted: Array | None = None
    lost: Mask | None = None
    lag_ms: float | None = None

    @property
    def stop(self) -> int:
        """The frame after the last."""
        return self.start + len(self.weights)

    @classmethod
    def between(cls, before: Take, after: Take, frames: tuple[int, int]) -> Patch:
        """Return the patch that turns one take into another over a half-open range, without control targets.

        The range is grown over the lost frames beside it, which follow what changed.
        """
        if before.weights.shape != after.weights.shape:
            raise EditError(f"The new weights have {counted(len(after), 'frame')}, the take {len(before)}.")
        first, last = before.with_lost_beside(*frames)
        rows = np.asarray(after.weights[first:last])
        reached = bundled_face().measure(rows)
        return cls(first, rows, np.full_like(reached, np.nan), reached, lost=after.lost[first:last])

    def apply(self, take: Take) -> Take:
        """Return the take with these weights in place."""
        if self.lost is None:
            return take.with_rows(self.start, self.weights)
        return take.with_exact_rows(self.start, self.weights, self.lost)

    def settled(self, take: Take) -> Patch:
        """Return the patch over every frame of a take that it changes, with which of them are lost."""
        if self.lost is not None:
            return self
        whole = Patch.between(take, self.apply(take), (self.start, self.stop))
        asked, reached = whole.asked.copy(), whole.reached.copy()
        inside = slice(self.start - whole.start, self.stop - whole.start)
        same = (whole.weights[inside] == self.weights).all(axis=1)[:, None]
        asked[inside] = np.where(same, self.asked, asked[inside])
        reached[inside] = np.where(same, self.reached, reached[inside])
        granted = None
        if self.granted is not None:
            granted = np.full_like(asked, np.nan)
            granted[inside] = self.granted
        return Patch(whole.start, whole.weights, asked, reached, granted, whole.lost)
