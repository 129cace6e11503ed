"""Drags that overlap are one wish, solved against the take below them: so dragging back brings back, bit for bit."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from PySide6.QtGui import QUndoCommand

from app.session.session import Session
from engine.take import Array, Take


@dataclass(frozen=True, eq=False)
class Wish:
    """What is asked of a take, from frame `start`.

    Attributes
    ----------
    take, controls : what it is asked of, (frames, 16) measured on it
    held : (frames, 16) what edits below asked for, NaN where nothing
    asked : (n, 16) NaN where nothing is asked
    believability : of the edit
    """

    take: Take
    controls: Array
    held: Array
    start: int
    asked: Array
    believability: float

    @property
    def stop(self) -> int:
        """The frame after the last."""
        return self.start + len(self.asked)


@dataclass
class Wishes:
    """The wishes of the drags at the top of the undo stack, all of them asked of the same take.

    Attributes
    ----------
    session : whose undo stack it is
    """

    session: Session
    _made: list[tuple[QUndoCommand, Wish]] = field(default_factory=list)

    def asking(self, start: int, asked: Array) -> Wish:
        """Return the wish for curves, (n, 16) from frame `start`, together with those of the drags it overlaps."""
        session = self.session
        rows = slice(start, start + len(asked))
        new = np.where(asked == session.document.controls[rows], np.nan, asked)
        below = self._of_the_last_step()
        if below is None or below.believability != session.view.believability:
            return Wish(
                session.document.take,
                session.document.controls,
                session.document.asked,
                start,
                new,
                session.view.believability,
            )
        if not (below.start < start + len(new) and start < below.stop):
            return Wish(
                session.document.take,
                session.document.controls,
                session.document.asked,
                start,
                new,
                session.view.believability,
            )
        first, last = min(start, below.start), max(start + len(new), below.stop)
        both = np.full((last - first, new.shape[1]), np.nan)
        both[below.start - first : below.stop - first] = below.asked
        part = both[start - first : start - first + len(new)]
        part[...] = np.where(np.isnan(new), part, new)
        return Wish(below.take, below.controls, below.held, first, both, below.believability)

    def made(self, step: QUndoCommand, wish: Wish, *, start: int, stop: int) -> None:
        """Remember the step that a wish became, which moved the frames [start, stop)."""
        self._made = [(other, known) for other, known in self._made if known.take is wish.take]
        first, last = min(start, wish.start), max(stop, wish.stop)
        asked = np.full((last - first, wish.asked.shape[1]), np.nan)
        asked[wish.start - first : wish.stop - first] = wish.asked
        whole = Wish(wish.take, wish.controls, wish.held, first, asked, wish.believability)
        self._made.append((step, whole))

    def forget(self) -> None:
        """Drop all of them: another take was opened."""
        self._made = []

    def _of_the_last_step(self) -> Wish | None:
        undo = self.session.document.undo
        last = undo.command(undo.index() - 1) if undo.index() else None
        return next((wish for step, wish in self._made if step is last), None)
