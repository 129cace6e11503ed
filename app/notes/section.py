"""Remarks on frames and ranges: type one, go to it, change, answer, resolve or delete it."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QEvent, QObject, QPoint, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QComboBox, QLineEdit, QPushButton, QSizePolicy, QVBoxLayout

from app.notes import steps
from app.notes.telling import summary, whole
from app.session import Change, Session
from app.session.commands import MarkCommand
from app.widgets.section import Section, empty, quiet
from app.widgets.text import caption, tip
from engine.project import Drawing, Marks, Note, stamp
from engine.review.report import REGION_TITLES
from engine.words import plain

SHOWN = 8
LONGEST = 400  # characters
NEW, RANGE = "Note on this frame, then Enter", "Note on {}, then Enter"
CHANGED = "The note's new text, then Enter; Escape keeps the old one"
ANSWER = "Your reply, then Enter; Escape drops it"
REGIONS = {title: name for name, title in REGION_TITLES.items()}


class NotesSection(Section):
    """Adds, lists, changes, answers, resolves and deletes notes; each is one undo step and is kept in the project.

    Parameters
    ----------
    session : whose frames are remarked on

    Attributes
    ----------
    chosen : the note that was clicked last
    author : who writes
    drawn : gives what was drawn on the picture since the last note, and forgets it
    """

    menu_wanted = Signal(QPoint)  # on the screen, after the playhead went to the note
    drawing_wanted = Signal(bool)  # whether the picture of the face is to be drawn on
    looked_at = Signal(object)  # a Drawing to be seen from where it was drawn

    def __init__(self, session: Session) -> None:
        super().__init__(session, "Notes")
        self.author: Callable[[], str] = str
        self.drawn: Callable[[], Drawing | None] = lambda: None
        self.chosen: Note | None = None
        self._changing: Note | None = None
        self._answering: Note | None = None
        self.entry, self.region = QLineEdit(), QComboBox()
        self.entry.setPlaceholderText(NEW)
        self.entry.setMaxLength(LONGEST)
        self.entry.setAccessibleName("Note on this frame")
        self.entry.returnPressed.connect(self._typed)
        self.entry.installEventFilter(self)
        self.region.addItems(list(REGIONS))
        self.region.setAccessibleName("The part of the face that the note is on")
        self.region.setToolTip("The part of the face that the note is on")
        self.draw = QPushButton("Draw")
        self.draw.setCheckable(True)
        self.draw.setToolTip("Draw on the picture of the face; the lines go with the note")
        self.draw.toggled.connect(self.drawing_wanted)
        self.column.addWidget(self.entry)
        self.side_by_side(self.region, self.draw)
        self._list = QVBoxLayout()
        self._list.setSpacing(4)
        self.column.addLayout(self._list)
        self._lay_out_chosen()
        session.changed.connect(self._on_change)
        self._show()

    def _lay_out_chosen(self) -> None:
        self.whole_note = quiet("")
        self.reply, self.resolve, self.remove = (QPushButton(name) for name in ("Reply", "Resolve", "Delete"))
        self.reply.clicked.connect(lambda: self.answer(self.chosen))
        self.resolve.clicked.connect(lambda: self.settle(self.chosen))
        self.remove.clicked.connect(lambda: self.delete(self.chosen))
        self.column.addWidget(self.whole_note)
        self.side_by_side(self.reply, self.resolve, self.remove)

    # --- what is done with notes

    def begin(self, note: Note | None = None) -> None:
        """Let a note be typed, or the text of one that there is be changed."""
        self._take_up(note)
        self.entry.selectAll()
        self.entry.setFocus()

    def answer(self, note: Note | None) -> None:
        """Let a reply to a note be typed."""
        if note is not None:
            self._take_up(None)
            self._answering = note
            self.entry.setPlaceholderText(ANSWER)
            self.entry.setFocus()

    def settle(self, note: Note | None) -> None:
        """Call a note done, or open again."""
        if note is not None:
            new = steps.settled(note, author=self.author())
            title = "resolve a note" if new.resolved else "open a note again"
            self._put(steps.exchanged(self.session.document.marks, note, new), title, choose=new)

    def delete(self, note: Note | None) -> None:
        """Delete a note."""
        if note is not None:
            self._put(steps.deleted(self.session.document.marks, note), "delete a note")

    def go_to(self, note: Note, *_: bool) -> None:
        """Go to a note: its first frame, and with a drawing to where it was drawn from."""
        self.chosen = note
        self.session.view.move_playhead(note.frame)
        if note.frames > 1:
            self.session.view.select((note.frame, note.stop))
        if note.drawing is not None:
            self.looked_at.emit(note.drawing)
        self._show()

    def frames_here(self) -> tuple[int, int]:
        """Return what a new note is on, its first frame and how many: the selection around the playhead, or one frame."""
        here, chosen = self.session.view.playhead, self.session.view.selection
        return (chosen[0], chosen[1] - chosen[0]) if chosen and chosen[0] <= here < chosen[1] else (here, 1)

    def _take_up(self, note: Note | None) -> None:
        self._changing, self._answering = note, None
        self.entry.setText(plain(note.text) if note is not None else "")
        self.entry.setToolTip("" if note is None else CHANGED)
        region = REGION_TITLES.get(note.region if note is not None else "face", REGION_TITLES["face"])
        self.region.setCurrentText(region)
        self._invite()

    def _invite(self) -> None:
        """Say in the empty box what is typed there."""
        if self._answering is None:
            frame, frames = self.frames_here()
            new = NEW if frames == 1 else RANGE.format(f"frames {frame} to {frame + frames - 1}")
            self.entry.setPlaceholderText(new if self._changing is None else CHANGED)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Keep the old text of a note, or drop a reply, on Escape."""
        escape = isinstance(event, QKeyEvent) and event.key() == Qt.Key.Key_Escape
        busy = self._changing is not None or self._answering is not None
        if escape and busy and event.type() == QEvent.Type.ShortcutOverride:
            event.accept()
            return True
        if escape and busy and event.type() == QEvent.Type.KeyPress:
            self._take_up(None)
            self.entry.clearFocus()
            return True
        return False

    def _typed(self) -> None:
        """Keep what was typed: as a new note, as the new text of the one changed, or as a reply."""
        text, drawing, marks = self.entry.text().strip(), self.drawn(), self.session.document.marks
        changing, answering = self._changing, self._answering
        region = REGIONS[self.region.currentText()]
        if answering is not None and any(each is answering for each in marks.notes):
            if text:
                new = steps.answered(answering, text, author=self.author())
                self._put(steps.exchanged(marks, answering, new), "reply to a note", choose=new)
        elif changing is not None and any(each is changing for each in marks.notes):
            self._change(changing, text, region, drawing)
        elif text or drawing is not None:
            frame, frames = self.frames_here()
            new = Note(frame, self.author(), stamp(), text, frames, region, drawing=drawing)
            self._put(steps.added(marks, new), "add a note", choose=new)
        self.draw.setChecked(False)
        self._take_up(None)
        self.entry.clearFocus()  # the keys go to the lanes again

    def _change(self, note: Note, text: str, region: str, drawing: Drawing | None) -> None:
        if not text and drawing is None and note.drawing is None:
            self.delete(note)
            return
        kept = region if region != "face" or note.region in REGION_TITLES else note.region
        if text != plain(note.text) or kept != note.region or drawing is not None:
            new = steps.rewritten(note, text, author=self.author(), region=kept, drawing=drawing)
            self._put(steps.exchanged(self.session.document.marks, note, new), "change a note", choose=new)

    def _put(self, marks: Marks, title: str, *, choose: Note | None = None) -> None:
        self.session.document.undo.push(MarkCommand.of(self.session.document, marks, title))
        self.chosen = choose
        self._show()

    # --- the list

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.MARKS):
            notes = self.session.document.marks.notes
            for note in (self._changing, self._answering):
                if note is not None and not any(each is note for each in notes):
                    self._take_up(None)  # it is gone: what is typed is no change of it any more
            self._show()
        if change & (Change.TAKE | Change.PLAYHEAD | Change.SELECTION):
            self._invite()

    def _show(self) -> None:
        empty(self._list)
        notes, fps = self.session.document.marks.notes, self.session.document.take.fps
        if not any(note is self.chosen for note in notes):
            self.chosen = None
        for number, note in self._shown():
            head, text = (caption(line) for line in summary(note, number, fps))
            button = QPushButton(f"{head}\n{text}")
            button.setStyleSheet("text-align: left;")
            button.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)  # never wider than the rest
            button.setToolTip(tip(f"{whole(note)}\nRight-click for what can be done with it."))
            button.setProperty("quiet", note.resolved)
            button.setCheckable(True)
            button.setChecked(note is self.chosen)
            button.clicked.connect(partial(self.go_to, note))
            button.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
            button.customContextMenuRequested.connect(partial(self._open_menu, note, button))
            self._list.addWidget(button)
        if len(notes) > SHOWN:
            self._list.addWidget(quiet(f"and {len(notes) - SHOWN:,} more, in the notes lane"))
        still = sum(not note.resolved for note in notes)
        self.title.setText(f"Notes · {still:,} of {len(notes):,} open" if notes else "Notes")
        self._show_chosen()

    def _shown(self) -> list[tuple[int, Note]]:
        """Return the notes in the list with their numbers: the first ones, or those around the chosen one."""
        numbered = list(enumerate(self.session.document.marks.notes, 1))
        at = next((number - 1 for number, note in numbered if note is self.chosen), 0)
        first = min(max(0, at - SHOWN // 2), max(0, len(numbered) - SHOWN))
        return numbered[first : first + SHOWN]

    def _show_chosen(self) -> None:
        note = self.chosen
        self.whole_note.setText("" if note is None else whole(note))
        for widget in (self.whole_note, self.reply, self.resolve, self.remove):
            widget.setVisible(note is not None)
        self.resolve.setText("Open again" if note is not None and note.resolved else "Resolve")

    def _open_menu(self, note: Note, button: QPushButton, at: QPoint) -> None:
        place = button.mapToGlobal(at)  # before the list is made anew, and the button with it
        self.go_to(note)
        self.menu_wanted.emit(place)
