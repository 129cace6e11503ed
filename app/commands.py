"""Undoable steps: one finished gesture of the user each, with a name in the user's words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtGui import QUndoCommand

from app.session import Session

if TYPE_CHECKING:
    from engine.editing import Patch


class EditCommand(QUndoCommand):
    """Puts a patch in place; undoing brings back exactly the rows that were there.

    Parameters
    ----------
    session : what is edited
    patch : what the gesture came to
    title : what the user did, as the Undo menu shows it
    """

    def __init__(self, session: Session, patch: Patch, title: str) -> None:
        super().__init__(title)
        rows = slice(patch.start, patch.stop)
        self._session, self._start = session, patch.start
        self._before = (session.take.weights[rows].copy(), session.controls[rows].copy(), session.asked[rows].copy())
        asked = np.where(patch.asked != self._before[1], patch.asked, self._before[2])
        self._after = (patch.weights, patch.reached, asked)

    def redo(self) -> None:
        """Do it, first or again."""
        self._session.replace_rows(self._start, *self._after)

    def undo(self) -> None:
        """Take it back."""
        self._session.replace_rows(self._start, *self._before)
