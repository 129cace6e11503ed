"""The actions on automatic findings: what does not count, and what is looked for in this project."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QWidget

from app.dialogs.flags import FlagsDialog
from app.inspector.flags import FlagsSection
from app.session import Change, Session
from app.session.commands import MarkCommand
from engine.quality import FlagSettings


class FlagActions(QObject):
    """Each public method without arguments is an action of the table.

    Parameters
    ----------
    session : whose flags they are
    flags : the section in which a reason is typed
    window : the parent of the dialog
    """

    def __init__(self, session: Session, flags: FlagsSection, window: QWidget) -> None:
        super().__init__()
        self._session, self._flags, self._window = session, flags, window
        self.dialog: FlagsDialog | None = None
        flags.wanted.connect(self._carry_out)
        session.changed.connect(self._on_change)

    def dismiss_flag(self) -> None:
        """Let the finding at the playhead not count, and say why."""
        self._flags.begin_dismissing()

    def restore_flag(self) -> None:
        """Let the finding at the playhead count again."""
        self._flags.restore()

    def flag_settings(self) -> None:
        """Choose what is looked for in this project, and from which thresholds."""
        if self.dialog is None:
            self.dialog = FlagsDialog(self._session.document.marks.flags, self._window)
            self.dialog.changed.connect(self._set)
        self.dialog.show_settings(self._session.document.marks.flags)
        self.dialog.show()
        self.dialog.raise_()

    def _carry_out(self, name: str) -> None:
        getattr(self, name)()

    def _set(self, settings: FlagSettings, title: str) -> None:
        document = self._session.document
        document.undo.push(MarkCommand.of(document, replace(document.marks, flags=settings), title))

    def _on_change(self, change: Change) -> None:
        if self.dialog is not None and change & (Change.TAKE | Change.MARKS):
            self.dialog.show_settings(self._session.document.marks.flags)
