"""Undoable steps of retargeting."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from PySide6.QtGui import QUndoCommand

from app.commands import EditCommand
from app.retarget.carry import Target
from app.session import Session
from engine.character import Character

if TYPE_CHECKING:
    from engine.editing import Patch


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


class KeepCommand(EditCommand):
    """Puts what was carried in place, and the take on the head that it was carried to.

    Parameters
    ----------
    session, patch, title, inputs : as for any edit
    head : the head; None for the bundled one
    """

    def __init__(
        self, session: Session, patch: Patch, title: str, head: Character | None, inputs: Mapping[str, Any]
    ) -> None:
        super().__init__(session, patch, title, kind="retarget", inputs=inputs)
        self._heads = (session.character, head)

    def redo(self) -> None:
        """Do it, first or again."""
        super().redo()
        self._session.play_on(self._heads[1])

    def undo(self) -> None:
        """Take it back."""
        super().undo()
        self._session.play_on(self._heads[0])
