"""Remarks on frames: type one at the playhead, click one to go there, change or delete it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from functools import partial

from PySide6.QtCore import QEvent, QObject, QPoint, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QLineEdit, QPushButton, QSizePolicy, QVBoxLayout

from app.session import Change, Session
from app.session.commands import MarkCommand
from app.widgets.section import Section, empty, quiet
from app.widgets.text import caption, tip
from engine.project import Note
from engine.take import timecode
from engine.words import plain

SHOWN = 8
LONGEST = 400  # characters
SHOWN_CHARACTERS = 19
NEW, CHANGED = "Note on this frame, then Enter", "The note's new text, then Enter; Escape keeps the old one"


class NotesSection(Section):
    """Adds, lists, changes and deletes notes; each is one undo step and is kept in the project.

    Parameters
    ----------
    session : whose frames are remarked on

    Attributes
    ----------
    chosen : the note that was clicked last
    """

    menu_wanted = Signal(QPoint)  # on the screen, after the playhead went to the note

    def __init__(self, session: Session) -> None:
        super().__init__(session, "Notes")
        self.author: Callable[[], str] = str  # who writes
        self.chosen: Note | None = None
        self._changing: Note | None = None
        self.entry = QLineEdit()
        self.entry.setPlaceholderText(NEW)
        self.entry.setMaxLength(LONGEST)
        self.entry.setAccessibleName("Note on this frame")
        self.entry.returnPressed.connect(self._typed)
        self.entry.installEventFilter(self)
        self.column.addWidget(self.entry)
        self._list = QVBoxLayout()
        self._list.setSpacing(4)
        self.column.addLayout(self._list)
        session.changed.connect(self._on_change)
        self._show()

    def begin(self, note: Note | None = None) -> None:
        """Let a note be typed, or the text of one that there is be changed."""
        self._take_up(note)
        self.entry.selectAll()
        self.entry.setFocus()

    def _take_up(self, note: Note | None) -> None:
        self._changing = note
        self.entry.setText(plain(note.text) if note is not None else "")
        self.entry.setPlaceholderText(NEW if note is None else CHANGED)
        self.entry.setToolTip("" if note is None else CHANGED)

    def delete(self, note: Note) -> None:
        """Delete a note."""
        self._put([each for each in self.session.document.marks.notes if each is not note], "delete a note")

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Keep the old text of a note on Escape."""
        escape = isinstance(event, QKeyEvent) and event.key() == Qt.Key.Key_Escape
        if escape and self._changing is not None and event.type() == QEvent.Type.ShortcutOverride:
            event.accept()
            return True
        if escape and self._changing is not None and event.type() == QEvent.Type.KeyPress:
            self._take_up(None)
            self.entry.clearFocus()
            return True
        return False

    def _typed(self) -> None:
        """Keep what was typed: as a new note on the frame at the playhead, or as the new text of the one changed."""
        text, old, session = self.entry.text().strip(), self._changing, self.session
        notes = list(session.document.marks.notes)
        now = datetime.now(UTC).isoformat(timespec="seconds")
        if old is not None and old in notes:
            if text and text != plain(old.text):
                new = replace(old, author=self.author() or old.author, time=now, text=text)
                self._put([new if each is old else each for each in notes], "change a note")
            elif not text:
                self.delete(old)
        elif text:
            self._put([*notes, Note(session.view.playhead, self.author(), now, text)], "add a note")
        self._take_up(None)

    def _put(self, notes: list[Note], title: str) -> None:
        session = self.session
        ordered = tuple(sorted(notes, key=lambda each: each.frame))
        session.document.undo.push(MarkCommand.of(session.document, replace(session.document.marks, notes=ordered), title))

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.MARKS):
            if self._changing is not None and self._changing not in self.session.document.marks.notes:
                self._take_up(None)  # it is gone: what is typed is no change of it any more
            self._show()

    def _show(self) -> None:
        empty(self._list)
        notes, fps = self.session.document.marks.notes, self.session.document.take.fps
        for note in notes[:SHOWN]:
            text = plain(note.text)
            shown = text if len(text) <= SHOWN_CHARACTERS else f"{text[: SHOWN_CHARACTERS - 1]}…"
            button = QPushButton(caption(f"{timecode(note.frame / fps, fps)}  {shown}"))
            button.setStyleSheet("text-align: left;")
            button.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)  # never wider than the rest
            button.setToolTip(tip(f"{note.text}\n{note.author}, {note.time}\nRight-click to change or delete it."))
            button.clicked.connect(partial(self._go_to, note))
            button.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
            button.customContextMenuRequested.connect(partial(self._open_menu, note, button))
            self._list.addWidget(button)
        if len(notes) > SHOWN:
            self._list.addWidget(quiet(f"and {len(notes) - SHOWN:,} more, in the notes lane"))

    def _go_to(self, note: Note, *_: bool) -> None:
        self.chosen = note
        self.session.view.move_playhead(note.frame)

    def _open_menu(self, note: Note, button: QPushButton, at: QPoint) -> None:
        self._go_to(note)
        self.menu_wanted.emit(button.mapToGlobal(at))
