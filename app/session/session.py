"""The one owner of what is open: the document, the view of it, and the one signal that says what changed."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoCommand

from app.session.changes import Change
from app.session.document import Document
from app.session.view import View
from engine.character import Character
from engine.project import Contents, Replayed
from engine.take import Array, Take


class Session(QObject):
    """Both halves and their one signal; widgets read them, commands change the document.

    Attributes
    ----------
    document : what is edited and kept
    view : what is shown of it, and the tool in use
    """

    changed = Signal(object)  # a Change

    def __init__(self, take: Take) -> None:
        super().__init__()
        self.document = Document(take)
        self.view = View(self.document)
        for half in (self.document, self.view):
            half.changed.connect(self.changed)

    def open(self, take: Take, path: Path | None, measured: Array | None = None) -> None:
        """Replace everything by a take, whose controls may have been measured before, (frames, 16)."""
        other_head = self.document.character is not None
        self.document.open(take, path, measured)
        self._reset_view(other_head=other_head)

    def restore(
        self,
        contents: Contents,
        path: Path | None,
        steps: Iterable[QUndoCommand],
        state: Replayed,
        measured: tuple[Array, Array],
    ) -> None:
        """Replace everything by what a project holds: its edits as `steps`, which come to `state`.

        The controls, (frames, 16), are `measured` of the original as it is read there, and of that state.
        """
        other_head = self.document.character is not None
        self.document.restore(contents, path, steps, state, measured)
        self._reset_view(other_head=other_head)

    def play_on(self, head: Character | None) -> None:
        """Set the head that the weights are for, and show the take on it; None is the bundled one."""
        self.document.play_on(head)
        self.view.show_on(head)

    def _reset_view(self, *, other_head: bool) -> None:
        """Show the start of another take, on the bundled head where the take before was for another one."""
        self.view.reset()
        if other_head:
            self.view.head = None
        self.changed.emit(Change.TAKE | Change.CHARACTER | Change.HEAD if other_head else Change.TAKE)
