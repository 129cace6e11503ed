"""Remarks on frames: type one at the playhead, click one to go there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime

from PySide6.QtWidgets import QLineEdit, QPushButton, QSizePolicy, QVBoxLayout

from app.session import Change, Session
from app.session.commands import MarkCommand
from app.widgets.section import Section, empty
from engine.project import Note
from engine.take import timecode

SHOWN = 8
LONGEST = 400  # characters


class NotesSection(Section):
    """Adds, lists and removes notes; each is one undo step and is kept in the project.

    Parameters
    ----------
    session : whose frames are remarked on
    """

    def __init__(self, session: Session) -> None:
        super().__init__(session, "Notes")
        self.author: Callable[[], str] = str  # who writes
        self.entry = QLineEdit()
        self.entry.setPlaceholderText("Note on this frame, then Enter")
        self.entry.setMaxLength(LONGEST)
        self.entry.setAccessibleName("Note on this frame")
        self.entry.returnPressed.connect(self.add)
        self.column.addWidget(self.entry)
        self._list = QVBoxLayout()
        self._list.setSpacing(4)
        self.column.addLayout(self._list)
        session.changed.connect(self._on_change)
        self._show()

    def add(self) -> None:
        """Keep what was typed as a note on the frame at the playhead."""
        text = self.entry.text().strip()
        if not text:
            return
        session = self.session
        now = datetime.now(UTC).isoformat(timespec="seconds")
        note = Note(session.playhead, self.author(), now, text)
        notes = tuple(sorted((*session.marks.notes, note), key=lambda each: each.frame))
        session.undo.push(MarkCommand(session, replace(session.marks, notes=notes), "add a note"))
        self.entry.clear()

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.MARKS):
            self._show()

    def _show(self) -> None:
        empty(self._list)
        fps = self.session.take.fps
        for note in self.session.marks.notes[:SHOWN]:
            shown = note.text if len(note.text) < 20 else f"{note.text[:18]}…"
            button = QPushButton(f"{timecode(note.frame / fps, fps)}  {shown}")
            button.setStyleSheet("text-align: left;")
            button.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)  # never wider than the rest
            button.setToolTip(f"{note.text}\n{note.author}, {note.time}")
            button.clicked.connect(lambda _=False, frame=note.frame: self.session.move_playhead(frame))
            self._list.addWidget(button)
