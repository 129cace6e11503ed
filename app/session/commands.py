"""Undoable steps: one finished gesture of the user each, with a name in the user's words."""

from __future__ import annotations

import weakref
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np
from PySide6.QtGui import QUndoCommand

from app.session.document import MEDIA, Document
from engine.extended import bundled_face
from engine.formats.base.reading import ReadAs
from engine.project import (
    ALIGN,
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
from engine.take import Array, Mask

if TYPE_CHECKING:
    from engine.editing import Patch
    from engine.project import Before

State = TypeVar("State")


class Step(QUndoCommand, Generic[State]):
    """One undoable step: puts one state of a part of the document in place of another.

    A kind of step says in `_put` how; `of` makes one from what the user did, `restored` from what a project file keeps.

    Parameters
    ----------
    document : what is changed
    edit : what a project file keeps of the step; its title is what the Undo menu shows
    before, after : what the step found, and what it leaves
    """

    def __init__(self, document: Document, edit: Edit, *, before: State, after: State) -> None:
        super().__init__(edit.title)
        self._owner = weakref.ref(document)  # its stack has the step, and neither would ever be freed
        self.edit, self._before, self._after = edit, before, after

    @property
    def _document(self) -> Document:
        document = self._owner()
        assert document is not None
        return document

    def redo(self) -> None:
        """Do it, first or again."""
        self._put(self._after, instead_of=self._before)

    def undo(self) -> None:
        """Take it back."""
        self._put(self._before, instead_of=self._after)

    def _put(self, state: State, *, instead_of: State) -> None:
        raise NotImplementedError


@dataclass(frozen=True, eq=False)
class Rows:
    """The rows that a step puts in place, and the marks that go with them.

    Attributes
    ----------
    weights : (n, 52)
    controls : (n, 16) measured on them
    asked : (n, 16) what was asked of them, NaN where nothing was
    lost : (n,) frames that nothing has given motion yet
    marks : None where the step leaves the marks as they are
    """

    weights: Array
    controls: Array
    asked: Array
    lost: Mask
    marks: Marks | None = None


class EditCommand(Step[Rows]):
    """Puts a patch in place; undoing brings back exactly the rows that were there.

    Attributes
    ----------
    granted : what was believable of it; None of a step from a project file
    """

    granted: Array | None = None

    @classmethod
    def of(
        cls,
        document: Document,
        patch: Patch,
        title: str,
        *,
        kind: str = "drag",
        inputs: Mapping[str, Any] | None = None,
        marks: Marks | None = None,
    ) -> EditCommand:
        """Return the step to a patch.

        `kind` and `inputs` are the verb and what it was done with, so that a project file can tell and repeat it; `marks`
        is what the document's become with it.
        """
        patch = patch.settled(document.take)
        assert patch.lost is not None
        rows, take = slice(patch.start, patch.stop), document.take
        had = document.asked[rows].copy()
        asked = np.where(np.isnan(patch.asked), had, patch.asked)
        edit = Edit(kind, title, patch.start, patch.weights, asked, inputs or {}, patch.lost)
        marks_before = document.marks if marks is not None else None
        step = cls(
            document,
            edit,
            before=Rows(
                take.weights[rows].copy(), document.controls[rows].copy(), had, take.lost[rows].copy(), marks_before
            ),
            after=Rows(patch.weights, patch.reached, asked, patch.lost, marks),
        )
        step.granted = patch.granted
        return step

    @classmethod
    def restored(cls, document: Document, edit: Edit, before: Before) -> EditCommand:
        """Return the step of a stored edit, which replaced `before`: (n, 52) weights, (n, 16) asked values, lost frames."""
        measure = bundled_face().measure
        weights, asked, lost = before
        after = Rows(edit.weights, measure(edit.weights), edit.asked, edit.still_lost(weights, lost))
        return cls(document, edit, before=Rows(weights, measure(weights), asked, lost), after=after)

    @property
    def asked(self) -> tuple[int, Array] | None:
        """The first frame and the curves, (n, 16) with NaN, that this step asked for; None where it asked for no curve."""
        if "believability" not in self.edit.inputs:
            return None
        after = self._after.asked
        return self.edit.start, np.where(after == self._before.asked, np.nan, after)

    @property
    def before(self) -> tuple[Array, Array]:
        """The controls of the rows that were there, (n, 16), and what had been asked of them."""
        return self._before.controls, self._before.asked

    def _put(self, state: Rows, *, instead_of: Rows) -> None:
        self._document.replace_rows(self.edit.start, state.weights, state.controls, state.asked, state.lost)
        if state.marks is not None and instead_of.marks is not None:
            put_marks(self._document, state.marks, instead_of=instead_of.marks)


class MarkCommand(Step[Marks]):
    """Puts other spans, pins or notes in place."""

    @classmethod
    def of(cls, document: Document, marks: Marks, title: str) -> MarkCommand:
        """Return the step to other marks."""
        before = document.marks
        return cls(document, mark_edit(title, before, marks), before=before, after=marks)

    @classmethod
    def restored(cls, document: Document, edit: Edit) -> MarkCommand:
        """Return the step of a stored edit."""
        before, after = (marks_of(edit.inputs[name]) for name in ("before", "after"))
        return cls(document, edit, before=before, after=after)

    def _put(self, state: Marks, *, instead_of: Marks) -> None:
        put_marks(self._document, state, instead_of=instead_of)


def put_marks(document: Document, marks: Marks, *, instead_of: Marks) -> None:
    """Put marks in place of those that a step found; sound and video that the step was not about stay as they are.

    They are found beside a take a while after it was opened: undoing a step from before must not lose them.
    """
    for kind in MEDIA:
        if marks.medium(kind) == instead_of.medium(kind):
            marks = marks.with_medium(kind, document.marks.medium(kind))
    document.set_marks(marks)


class VisemesCommand(Step[VisemeChange]):
    """Puts another visemes lane in place, or none."""

    @classmethod
    def of(cls, document: Document, lane: VisemeLane | None, title: str) -> VisemesCommand:
        """Return the step to another lane."""
        change = change_between(document.visemes, lane)
        return cls.restored(document, viseme_edit(title, change), change)

    @classmethod
    def restored(cls, document: Document, edit: Edit, change: VisemeChange) -> VisemesCommand:
        """Return the step of a stored edit."""
        return cls(document, edit, before=change.inverse, after=change)

    def _put(self, state: VisemeChange, *, instead_of: VisemeChange) -> None:
        self._document.set_visemes(state.applied(self._document.visemes))


class ReadingCommand(Step[ReadAs]):
    """Reads the open take with another rate or other sides; the edits stay, and undoing goes back to the bit."""

    @classmethod
    def of(cls, document: Document, reading: ReadAs, title: str) -> ReadingCommand:
        """Return the step to another reading."""
        before = document.reading
        return cls(document, reading_edit(title, before, reading), before=before, after=reading)

    @classmethod
    def restored(cls, document: Document, edit: Edit) -> ReadingCommand:
        """Return the step of a stored edit."""
        before, after = (read_as_of(edit.inputs[name]) for name in ("before", "after"))
        return cls(document, edit, before=before, after=after)

    def _put(self, state: ReadAs, *, instead_of: ReadAs) -> None:
        self._document.read_as(state)


class AlignCommand(Step[tuple[Array, Mask]]):
    """Puts the take before at another time on the clock of the one after: its weights, (frames, 52), and lost frames."""

    @classmethod
    def of(cls, document: Document, edit: Edit) -> AlignCommand:
        """Return the step to the rows of an edit of the kind ALIGN."""
        before = document.original.weights, document.original.lost
        return cls(document, edit, before=before, after=(edit.weights, edit.still_lost(edit.weights, before[1])))

    @classmethod
    def restored(cls, document: Document, edit: Edit, before: Before) -> AlignCommand:
        """Return the step of a stored edit, which replaced the weights and lost frames of `before`."""
        weights, _, lost = before
        return cls(document, edit, before=(weights, lost), after=(edit.weights, edit.still_lost(edit.weights, lost)))

    def _put(self, state: tuple[Array, Mask], *, instead_of: tuple[Array, Mask]) -> None:
        self._document.set_original(*state)


def restored(document: Document, contents: Contents, state: Replayed) -> Iterator[QUndoCommand]:
    """Yield the steps of a project's edits, oldest first."""
    for edit, before, change in zip(contents.edits, state.before, state.changes, strict=True):
        if change is not None:
            yield VisemesCommand.restored(document, edit, change)
        elif edit.kind == MARK:
            yield MarkCommand.restored(document, edit)
        elif edit.kind == READING:
            yield ReadingCommand.restored(document, edit)
        elif edit.kind == ALIGN:
            yield AlignCommand.restored(document, edit, before)
        else:
            yield EditCommand.restored(document, edit, before)
