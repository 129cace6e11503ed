"""Edits under way: asked curves go to the networks on one background thread and come back as the session's draft."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app.background import LatestWins
from app.commands import EditCommand
from app.session import Change, Session
from engine.take import Array, Take

if TYPE_CHECKING:
    from engine.editing import Dragger, Patch


@dataclass(frozen=True, eq=False)
class Request:
    """Asked curves, (n, 8) in mm, for the frames of a take from `start`; `since` is when the user asked."""

    take: Take
    controls: Array
    start: int
    asked: Array
    exact: bool
    since: float = field(default_factory=time.perf_counter)


class Inference(QObject):
    """Turns asked curves into drafts while dragging, and the last draft into one undo step on release.

    Parameters
    ----------
    session : whose take is edited
    """

    failed = Signal(str, str)  # sentence, advice
    ready = Signal()  # the networks are loaded

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self._dragger: Dragger | None = None
        self._last: Request | None = None
        self._title: str | None = None  # set on release: the step to make of the last request's result
        self.since = 0.0  # when the draft on screen was asked for
        self._work = LatestWins(self._infer, name="inference")
        self._work.done.connect(self._arrived)
        self._work.failed.connect(self._refused)
        session.changed.connect(self._on_change)

    @property
    def busy(self) -> bool:
        """Whether an edit is under way."""
        return self._last is not None

    def warm_up(self) -> None:
        """Load the networks, after the window shows, so that the first drag is as fast as the next."""
        self._work.submit(None)

    def ask(self, start: int, asked: Array) -> None:
        """Show what the face does for asked curves, (n, 8) in mm, on the frames from `start`."""
        if self._title is not None:
            return  # the edit before is being finished; it takes a few milliseconds
        session = self._session
        self._last = Request(session.take, session.controls, start, asked, session.exact)
        self._work.submit(self._last)

    def finish(self, title: str) -> None:
        """Make the last asked curves one undo step, as soon as their result is there."""
        if self._last is None:
            return
        self._title = title
        draft = self._session.draft
        if self._work.idle and draft is not None:
            self._commit(draft)

    def cancel(self) -> None:
        """Forget the edit under way."""
        self._last = self._title = None
        self._session.set_draft(None)

    def close(self) -> None:
        """End the thread."""
        self._work.stop()

    def _infer(self, request: Request | None) -> Patch | None:
        # here and not above: torch takes a second to load, and the window should be seen first
        from engine import editing

        if request is None:
            editing.warm_up()
            return None
        if self._dragger is None or self._dragger.take is not request.take:
            self._dragger = editing.Dragger(request.take, request.controls)
        return self._dragger.drag(request.start, request.asked, exact_curve=request.exact)

    def _arrived(self, request: Request | None, patch: Patch | None) -> None:
        if request is None or patch is None:
            self.ready.emit()
            return
        if self._last is None or request.take is not self._session.take:
            return  # cancelled, or another take was opened meanwhile
        self.since = request.since
        self._session.set_draft(patch)
        if self._title is not None and request is self._last:
            self._commit(patch)

    def _commit(self, patch: Patch) -> None:
        title, self._title, self._last = self._title, None, None
        self._session.undo.push(EditCommand(self._session, patch, title or "edit"))

    def _refused(self, request: object, sentence: str, advice: str) -> None:
        self._last = self._title = None
        self._session.set_draft(None)
        self.failed.emit(sentence, advice)

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE:
            self._last = self._title = None
