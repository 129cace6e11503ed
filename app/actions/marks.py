"""The actions on what people put beside the curves: notes, pins and spans at the playhead."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QObject, Signal

from app.notes.section import NotesSection
from app.notes.steps import following
from app.session import Session
from app.session.commands import MarkCommand
from app.spans.section import SpansSection
from engine.project import Note


class MarkActions(QObject):
    """Each public method without arguments is an action of the table.

    Parameters
    ----------
    session : whose marks they are
    notes, spans : the sections in which notes are typed and spans are chosen
    """

    failed = Signal(str, str)  # sentence, advice
    message = Signal(str)  # what is to be known in passing

    def __init__(self, session: Session, notes: NotesSection, spans: SpansSection) -> None:
        super().__init__()
        self._session, self._notes, self._spans = session, notes, spans

    def fill(self) -> None:
        """Fill the chosen span, or the selection."""
        self._spans.fill()

    def unmark_span(self) -> None:
        """Remove the chosen span; its frames stay as they are."""
        if self._spans.chosen is None:
            self.failed.emit("No span is chosen.", "Click one in the spans lane.")
        self._spans.unmark()

    def note(self) -> None:
        """Type a note on the frame at the playhead."""
        self._notes.begin()

    def edit_note(self) -> None:
        """Change the text of the note at the playhead."""
        if (note := self._note_here()) is not None:
            self._notes.begin(note)

    def delete_note(self) -> None:
        """Delete the note at the playhead."""
        if (note := self._note_here()) is not None:
            self._notes.delete(note)

    def reply_note(self) -> None:
        """Answer the note at the playhead."""
        self._notes.answer(self._note_here())

    def resolve_note(self) -> None:
        """Call the note at the playhead done, or open again."""
        self._notes.settle(self._note_here())

    def next_note(self) -> None:
        """Go to the next note that is open."""
        self._step(1)

    def previous_note(self) -> None:
        """Go to the open note before."""
        self._step(-1)

    def draw_mark(self) -> None:
        """Draw on the picture of the face, or no longer."""
        self._notes.draw.toggle()

    def _step(self, by: int) -> None:
        session, notes = self._session, self._notes
        note = following(session.document.marks.notes, session.view.playhead, notes.chosen, by=by)
        if note is not None:
            notes.go_to(note)
        else:
            self.message.emit(f"No open note {'after' if by > 0 else 'before'} this frame.")

    def remove_pin(self) -> None:
        """Remove the pin at the playhead; the pose stays as it is."""
        session = self._session
        rest = tuple(pin for pin in session.document.marks.pins if pin.frame != session.view.playhead)
        if rest == session.document.marks.pins:
            self.failed.emit("There is no pin on this frame.", "Right-click one in the pins lane.")
        else:
            session.document.undo.push(
                MarkCommand.of(session.document, replace(session.document.marks, pins=rest), "remove a pin")
            )

    def _note_here(self) -> Note | None:
        """Return the note at the playhead: the chosen one, else the newest that begins here, else any around it."""
        chosen, frame = self._notes.chosen, self._session.view.playhead
        around = [note for note in self._session.document.marks.notes if note.frame <= frame < note.stop]
        if not around:
            self.failed.emit("There is no note on this frame.", "Right-click one in the notes lane.")
            return None
        begins = [note for note in around if note.frame == frame]
        return next((note for note in around if note is chosen), (begins or around)[-1])
