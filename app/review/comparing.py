"""Keeps the list of changes up to date on a thread of its own, and reads the take to compare with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from app.background import LatestWins
from app.session import Change, Session
from engine.errors import EngineError
from engine.formats import read_take
from engine.project import Edit
from engine.review.changes import Change as Difference
from engine.review.changes import Edited, compare
from engine.review.pairing import Pair, align_edit, found_again, on_its_clock, pair, paired_by
from engine.take import Take


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
class _Shift:
    """A take before that is to lie at another time: in memory, or in the file that it was read from."""

    original: Take
    after: Take
    raw: Take | Path
    offset_s: float


class Comparing(QObject):
    """Compares the open take with its recording, while the result is shown.

    Parameters
    ----------
    session : whose take is compared
    """

    changed = Signal(object)  # the tuple of changes
    paired = Signal(object, object)  # the take that was open, a Pair
    aligned = Signal(object)  # the Edit that puts the take before at another time
    failed = Signal(str, str)  # sentence, advice
    stepped = Signal()  # something was done or undone: how the two takes lie may have changed

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self._watched = False
        self._raw: tuple[Take, Take] | None = None  # the take that is open as recorded, and the one before on its clock
        self._work = LatestWins(_carry_out, name="review")
        self._work.done.connect(self._arrived)
        self._work.failed.connect(self._refused)
        session.changed.connect(self._on_change)
        session.document.undo.indexChanged.connect(self._on_step)

    @property
    def idle(self) -> bool:
        """Whether nothing is being compared."""
        return self._work.idle

    @property
    def alignment_inputs(self) -> Mapping[str, Any] | None:
        """How the two takes were brought together; None where there is no second one."""
        return paired_by(self._edits())

    def watch(self, on: bool) -> None:
        """Keep the list up to date from now on, or no longer."""
        self._watched = on
        if on:
            self._look()

    def read(self, path: Path) -> None:
        """Read a take to compare the open one with; `paired` follows."""
        self._work.submit(_Wish(self._session.document.take, path), "read")

    def _refused(self, request: object, sentence: str, advice: str) -> None:
        self.failed.emit(sentence, advice)

    def remember(self, raw: Take) -> None:
        """Keep the take before as it was, for the pair that is open from now on."""
        self._raw = self._session.document.recorded, raw

    def shift(self, offset_s: float) -> None:
        """Put the take before at another time; `aligned` follows, or `failed` where that take is not there any more."""
        session, inputs = self._session, self.alignment_inputs
        raw: Take | Path | None = None
        if self._raw is not None and self._raw[0] is session.document.recorded:
            raw = self._raw[1]
        elif inputs is not None and session.document.path is not None:
            raw = found_again(inputs, session.document.path)
        if raw is None:
            self.failed.emit(
                "The take before is not where it was, so it cannot be moved.", "Compare the two takes again."
            )
        else:
            self._work.submit(_Shift(session.document.original, session.document.take, raw, offset_s), "shift")

    def close(self) -> None:
        """End the thread."""
        self._session.changed.disconnect(self._on_change)
        self._session.document.undo.indexChanged.disconnect(self._on_step)
        self._work.stop()

    def _on_change(self, change: Change) -> None:
        if self._watched and change & Change.TAKE:
            self._look()

    def _on_step(self, _: int) -> None:
        """Look again once the undo stack knows of a step: while it is done, the stack does not count it yet."""
        if self._session.document.opening:
            return
        self.stepped.emit()
        if self._watched:
            self._look()

    def _edits(self) -> list[Edit]:
        """Return the edits in effect."""
        stack = self._session.document.undo
        found = (getattr(stack.command(index), "edit", None) for index in range(stack.index()))
        return [edit for edit in found if edit is not None]

    def _look(self) -> None:
        session = self._session
        edits = tuple(Edited(edit.title, edit.start, edit.stop) for edit in self._edits() if edit.changes_frames)
        self._work.submit(_Look(session.document.original, session.document.take, edits))

    def _arrived(self, request: object, result: object) -> None:
        original = self._session.document.original
        if isinstance(request, _Wish):
            self.paired.emit(request.take, result)
        elif isinstance(request, _Look) and request.original is original:
            self.changed.emit(result)
        elif isinstance(request, _Shift) and request.original is original:
            self.aligned.emit(result)


def _carry_out(request: _Look | _Wish | _Shift) -> tuple[Difference, ...] | Pair | Edit:
    if isinstance(request, _Look):
        return compare(request.original, request.take, offset_s=0.0, edits=request.edits).changes
    if isinstance(request, _Wish):
        found = pair(request.take, read_take(request.path))
        _ = found.patch  # it takes long: on this thread, and it is kept
        return found
    return _shifted(request)


def _shifted(request: _Shift) -> Edit:
    raw = read_take(request.raw) if isinstance(request.raw, Path) else request.raw
    offset_s = request.offset_s
    weights, lost, _ = on_its_clock(raw, request.after, offset_s)
    if len(weights) != len(request.original):
        raise EngineError("The takes have another length by now.", "Compare them again.")
    frames = offset_s * request.after.fps
    return align_edit(f"align at {frames:+g} frames", weights, lost, {"offset_s": offset_s, "by": "offset"})
