"""Undoable steps: one finished gesture of the user each, with a name in the user's words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtGui import QUndoCommand

from app.session.session import MEDIA, Session
from engine.extended import bundled_face
from engine.formats.base.reading import ReadAs
from engine.project import (
    MARK,
    READING,
    Contents,
    Edit,
    Marks,
    Replayed,
    VisemeChange,
    change_between,
    mark_edit,
    marks_of,
    read_as_of,
    reading_edit,
    viseme_edit,
)
from engine.speech.lane import VisemeLane

if TYPE_CHECKING:
    from engine.editing import Patch
    from engine.project import Before
    from engine.take import Array


class EditCommand(QUndoCommand):
    """Puts a patch in place; undoing brings back exactly the rows that were there.

    Parameters
    ----------
    session : what is edited
    patch : what the gesture came to
    title : what the user did, as the Undo menu shows it
    marks : what the session's marks become with it, if anything
    kind, inputs : the verb, and what it was done with, so that a project file can tell and repeat it
    """

    def __init__(
        self,
        session: Session,
        patch: Patch,
        title: str,
        *,
        kind: str = "drag",
        inputs: Mapping[str, Any] | None = None,
        marks: Marks | None = None,
    ) -> None:
        super().__init__(title)
        self._marks = (session.marks, marks) if marks is not None else None
        patch = patch.settled(session.take)
        assert patch.lost is not None
        rows, take = slice(patch.start, patch.stop), session.take
        self._session, self._start = session, patch.start
        had = session.asked[rows].copy()
        self._before = (take.weights[rows].copy(), session.controls[rows].copy(), had, take.lost[rows].copy())
        asked = np.where(np.isnan(patch.asked), had, patch.asked)
        self._after = (patch.weights, patch.reached, asked, patch.lost)
        self.granted = patch.granted  # what was believable of it; not known of a step from a project file
        self.edit = Edit(kind, title, patch.start, patch.weights, asked, inputs or {}, patch.lost)

    @property
    def asked(self) -> tuple[int, Array] | None:
        """The first frame and the curves, (n, 16) with NaN, that this step asked for; None where it asked for no curve."""
        if "believability" not in self.edit.inputs:
            return None
        return self._start, np.where(self._after[2] == self._before[2], np.nan, self._after[2])

    @property
    def before(self) -> tuple[Array, Array]:
        """The controls of the rows that were there, (n, 16), and what had been asked of them."""
        return self._before[1], self._before[2]

    @classmethod
    def restored(cls, session: Session, edit: Edit, before: Before) -> EditCommand:
        """Return the command of a stored edit, which replaced `before`: (n, 52) weights, (n, 16) asked values, lost frames."""
        command = cls.__new__(cls)
        QUndoCommand.__init__(command, edit.title)
        measure = bundled_face().measure
        command._session, command._start, command.edit = session, edit.start, edit
        command._marks = command.granted = None
        weights, asked, lost = before
        command._before = (weights, measure(weights), asked, lost)
        command._after = (edit.weights, measure(edit.weights), edit.asked, edit.still_lost(weights, lost))
        return command

    def redo(self) -> None:
        """Do it, first or again."""
        self._session.replace_rows(self._start, *self._after)
        if self._marks is not None:
            put_marks(self._session, self._marks[1], instead_of=self._marks[0])

    def undo(self) -> None:
        """Take it back."""
        self._session.replace_rows(self._start, *self._before)
        if self._marks is not None:
            put_marks(self._session, self._marks[0], instead_of=self._marks[1])


class MarkCommand(QUndoCommand):
    """Puts other spans, pins or notes in place.

    Parameters
    ----------
    session : what is marked
    marks : what it shall hold
    title : what the user did, as the Undo menu shows it
    """

    def __init__(self, session: Session, marks: Marks, title: str) -> None:
        super().__init__(title)
        self._session, self._before, self._after = session, session.marks, marks
        self.edit = mark_edit(title, self._before, marks)

    @classmethod
    def restored(cls, session: Session, edit: Edit) -> MarkCommand:
        """Return the command of a stored edit."""
        command = cls.__new__(cls)
        QUndoCommand.__init__(command, edit.title)
        command._session, command.edit = session, edit
        command._before, command._after = marks_of(edit.inputs["before"]), marks_of(edit.inputs["after"])
        return command

    def redo(self) -> None:
        """Do it, first or again."""
        put_marks(self._session, self._after, instead_of=self._before)

    def undo(self) -> None:
        """Take it back."""
        put_marks(self._session, self._before, instead_of=self._after)


def put_marks(session: Session, marks: Marks, *, instead_of: Marks) -> None:
    """Put marks in place of those that a step found; sound and video that the step was not about stay as they are.

    They are found beside a take a while after it was opened: undoing a step from before must not lose them.
    """
    for kind in MEDIA:
        if marks.medium(kind) == instead_of.medium(kind):
            marks = marks.with_medium(kind, session.marks.medium(kind))
    session.set_marks(marks)


class VisemesCommand(QUndoCommand):
    """Puts another visemes lane in place, or none.

    Parameters
    ----------
    session : whose visemes
    lane : what they become
    title : what the user did, as the Undo menu shows it
    """

    def __init__(self, session: Session, lane: VisemeLane | None, title: str) -> None:
        super().__init__(title)
        self._session, self._change = session, change_between(session.visemes, lane)
        self.edit = viseme_edit(title, self._change)

    @classmethod
    def restored(cls, session: Session, edit: Edit, change: VisemeChange) -> VisemesCommand:
        """Return the command of a stored edit."""
        command = cls.__new__(cls)
        QUndoCommand.__init__(command, edit.title)
        command._session, command._change, command.edit = session, change, edit
        return command

    def redo(self) -> None:
        """Do it, first or again."""
        self._session.set_visemes(self._change.applied(self._session.visemes))

    def undo(self) -> None:
        """Take it back."""
        self._session.set_visemes(self._change.inverse.applied(self._session.visemes))


class ReadingCommand(QUndoCommand):
    """Reads the open take with another rate or other sides; the edits stay, and undoing goes back to the bit.

    Parameters
    ----------
    session : whose take
    reading : what it becomes
    title : what the user did, as the Undo menu shows it
    """

    def __init__(self, session: Session, reading: ReadAs, title: str) -> None:
        super().__init__(title)
        self._session, self._before, self._after = session, session.reading, reading
        self.edit = reading_edit(title, self._before, reading)

    @classmethod
    def restored(cls, session: Session, edit: Edit) -> ReadingCommand:
        """Return the command of a stored edit."""
        command = cls.__new__(cls)
        QUndoCommand.__init__(command, edit.title)
        command._session, command.edit = session, edit
        command._before, command._after = read_as_of(edit.inputs["before"]), read_as_of(edit.inputs["after"])
        return command

    def redo(self) -> None:
        """Do it, first or again."""
        self._session.read_as(self._after)

    def undo(self) -> None:
        """Take it back."""
        self._session.read_as(self._before)


def restored(session: Session, contents: Contents, state: Replayed) -> Iterator[QUndoCommand]:
    """Yield the commands of a project's edits, oldest first."""
    for edit, before, change in zip(contents.edits, state.before, state.changes, strict=True):
        if change is not None:
            yield VisemesCommand.restored(session, edit, change)
        elif edit.kind == MARK:
            yield MarkCommand.restored(session, edit)
        elif edit.kind == READING:
            yield ReadingCommand.restored(session, edit)
        else:
            yield EditCommand.restored(session, edit, before)
