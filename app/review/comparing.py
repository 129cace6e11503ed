"""Keeps the list of changes up to date on a thread of its own, and reads the take to compare with."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app.background import LatestWins
from app.session import Change, Session
from engine.errors import EditError
from engine.formats import read_take
from engine.review.align import Alignment, align, on_clock_of
from engine.review.changes import Change as Difference
from engine.review.changes import Edited, compare
from engine.take import Take

if TYPE_CHECKING:
    from engine.editing import Patch


@dataclass(frozen=True, eq=False)
class _Look:
    """Two takes to compare, and the edits between them."""

    original: Take
    take: Take
    edits: tuple[Edited, ...]


@dataclass(frozen=True, eq=False)
class _Wish:
    """A file to compare a take with."""

    take: Take
    path: Path


@dataclass(frozen=True, eq=False)
class Pair:
    """A take on the clock of another version of it, and the patch that turns it into that version.

    Attributes
    ----------
    before : the first take, as it was open, or on the clock of the second where the two differ in rate or length
    patch : turns it into the second
    name : of the second
    alignment : how one lies on the other's clock
    same_clock : whether `before` is the open take itself
    """

    before: Take
    patch: Patch
    name: str
    alignment: Alignment
    same_clock: bool


class Comparing(QObject):
    """Compares what is open with how it was recorded, while somebody looks at the result.

    Parameters
    ----------
    session : whose take is compared
    """

    changed = Signal(object)  # the tuple of changes
    paired = Signal(object, object)  # the take that was open, a Pair
    failed = Signal(str, str)  # sentence, advice

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self._watched = False
        self._work = LatestWins(_carry_out, name="review")
        self._work.done.connect(self._arrived)
        self._work.failed.connect(lambda _request, sentence, advice: self.failed.emit(sentence, advice))
        session.changed.connect(self._on_change)

    @property
    def idle(self) -> bool:
        """Whether nothing is being compared."""
        return self._work.idle

    def watch(self, on: bool) -> None:
        """Keep the list up to date from now on, or no longer."""
        self._watched = on
        if on:
            self._look()

    def read(self, path: Path) -> None:
        """Read a take to compare the open one with; `paired` follows."""
        self._work.submit(_Wish(self._session.document.take, path), "read")

    def close(self) -> None:
        """End the thread."""
        self._session.changed.disconnect(self._on_change)
        self._work.stop()

    def _on_change(self, change: Change) -> None:
        if self._watched and change & (Change.TAKE | Change.CURVES):
            self._look()

    def _look(self) -> None:
        session = self._session
        steps = (session.document.undo.command(index) for index in range(session.document.undo.index()))
        found = (getattr(step, "edit", None) for step in steps)
        edits = tuple(Edited(edit.title, edit.start, edit.stop) for edit in found if edit is not None)
        self._work.submit(_Look(session.document.original, session.document.take, edits))

    def _arrived(self, request: object, result: object) -> None:
        if isinstance(request, _Wish):
            self.paired.emit(request.take, result)
        elif isinstance(request, _Look) and request.original is self._session.document.original:
            self.changed.emit(result)


def _carry_out(request: _Look | _Wish) -> tuple[Difference, ...] | Pair:
    if isinstance(request, _Look):
        return compare(request.original, request.take, offset_s=0.0, edits=request.edits).changes
    return pair(request.take, read_take(request.path))


def pair(before: Take, after: Take) -> Pair:
    """Return two takes as one that can be opened and the patch between them.

    Raises `EditError` where the two have no frame in common.
    """
    alignment = align(before, after)
    same_clock = alignment.offset_s == 0 and before.fps == after.fps and len(before) == len(after)
    if not same_clock:
        weights, common = on_clock_of(after, before, alignment.offset_s)
        if not common.any():
            raise EditError(f"{before.name} and {after.name} have no frame in common.")
        before = Take(weights, after.fps, name=before.name, start_s=after.start_s, lost=after.lost & ~common)
    from engine.editing import Patch  # which loads torch: the window should be seen first

    patch = Patch.between(before, replace(after, origin=before.origin), (0, len(after)))
    return Pair(before, patch, after.name, alignment, same_clock)
