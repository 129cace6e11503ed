"""Drags that overlap are one wish, solved against the take below them: so dragging back brings back, bit for bit."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from PySide6.QtGui import QUndoCommand

from app.session.asked import Base
from app.session.session import Session
from engine.editing import DragRequest
from engine.take import Array

Wish = tuple[Base, DragRequest]


@dataclass
class Wishes:
    """The wishes of the drags at the top of the undo stack, all of them asked of the same take.

    Attributes
    ----------
    session : whose undo stack it is
    """

    session: Session
    _kept: list[tuple[QUndoCommand, Wish]] = field(default_factory=list)

    def asking(self, start: int, asked: Array) -> Wish:
        """Return the wish for curves, (n, 16) from frame `start`, together with those of the drags it overlaps."""
        document, believability = self.session.document, self.session.view.believability
        new = np.where(asked == document.controls[start : start + len(asked)], np.nan, asked)
        alone = Base.of(document), DragRequest(start, new, believability)
        below = self._of_the_last_step()
        if below is None or below[1].believability != believability:
            return alone
        base, wish = below
        stop, (_, last) = start + len(new), wish.frames
        if not (wish.start < stop and start < last):
            return alone
        first, last = min(start, wish.start), max(stop, last)
        both = _padded(wish.asked, wish.start - first, last - first)
        part = both[start - first : stop - first]
        part[...] = np.where(np.isnan(new), part, new)
        return base, DragRequest(first, both, believability)

    def kept(self, step: QUndoCommand, base: Base, wish: DragRequest, *, start: int, stop: int) -> None:
        """Remember the step that a wish became, which moved the frames [start, stop)."""
        self._kept = [(other, known) for other, known in self._kept if known[0].take is base.take]
        first, last = min(start, wish.start), max(stop, wish.frames[1])
        asked = _padded(wish.asked, wish.start - first, last - first)
        self._kept.append((step, (base, DragRequest(first, asked, wish.believability))))

    def forget(self) -> None:
        """Drop all of them: another take was opened."""
        self._kept = []

    def _of_the_last_step(self) -> Wish | None:
        undo = self.session.document.undo
        last = undo.command(undo.index() - 1) if undo.index() else None
        return next((wish for step, wish in self._kept if step is last), None)


def _padded(asked: Array, at: int, length: int) -> Array:
    """Return curves, (n, 16), as (length, 16) from row `at`, NaN around them."""
    padded = np.full((length, asked.shape[1]), np.nan)
    padded[at : at + len(asked)] = asked
    return padded
