"""Undoable steps of retargeting."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtGui import QUndoCommand

from app.retarget.target import Target


class TargetCommand(QUndoCommand):
    """Puts another target, or another state of its markers and labels, in place; no frame of the take changes.

    Parameters
    ----------
    put : takes a target
    before, after : what it was and what it becomes
    title : what the user did
    """

    def __init__(self, put: Callable[[Target], None], before: Target, after: Target, title: str) -> None:
        super().__init__(title)
        self._put, self._before, self._after = put, before, after

    def redo(self) -> None:
        """Do it, first or again."""
        self._put(self._after)

    def undo(self) -> None:
        """Take it back."""
        self._put(self._before)
