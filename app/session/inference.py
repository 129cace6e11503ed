"""Edits under way: each is worked out on one background thread and comes back as the session's draft."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, Signal

from app.background import LatestWins
from app.session.changes import Change
from app.session.commands import EditCommand
from app.session.session import Session
from app.session.wishes import Wish, Wishes
from engine.project import Marks
from engine.take import Array, Take

if TYPE_CHECKING:
    from engine.editing import Dragger, Patch

    Verb = Callable[[Dragger], Patch]


@dataclass(frozen=True, eq=False)
class Request:
    """A verb to carry out on a take whose controls and what was asked of them, (frames, 16), are known.

    Its result is for the take that is `open`; `since` is when the user asked.
    """

    open: Take
    take: Take
    controls: Array
    asked: Array
    verb: Verb
    since: float = field(default_factory=time.perf_counter)


class Inference(QObject):
    """Turns what the user asks for into drafts, and the last draft into one undo step.

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
        self._shown: Request | None = None  # whose result is the draft
        self._kind, self._inputs = "drag", dict[str, Any]()
        self._curves: tuple[int, Array] | None = None  # what was asked of the controls, if anything was
        self._wish: Wish | None = None  # that, with the drags below
        self._wishes = Wishes(session)
        self._marks: Marks | None = None
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

    @property
    def idle(self) -> bool:
        """Whether nothing is being worked out."""
        return self._work.idle

    def warm_up(self) -> None:
        """Load the networks, after the window shows, so that the first drag is as fast as the next."""
        self._work.submit(None)

    def ask(self, start: int, asked: Array) -> None:
        """Show what the face does for asked curves, (n, 16), on the frames from `start`; NaN asks for nothing."""
        wish = self._wishes.asking(start, asked)
        if self._submit(
            lambda dragger: dragger.drag(wish.start, wish.asked, believability=wish.believability),
            of=(wish.take, wish.controls, wish.held),
        ):
            self._curves, self._wish = (start, asked), wish

    def run(self, verb: Verb) -> None:
        """Show what a verb does; it is called on the background thread."""
        if self._submit(verb):
            self._curves = self._wish = None

    def _submit(self, verb: Verb, *, of: tuple[Take, Array, Array] | None = None) -> bool:
        if self._title is not None:
            return False  # the edit before is being finished; it takes a few milliseconds
        session = self._session
        self._last = Request(
            session.document.take,
            *(of or (session.document.take, session.document.controls, session.document.asked)),
            verb,
        )
        self._work.submit(self._last)
        return True

    def finish(
        self,
        title: str,
        *,
        kind: str = "drag",
        inputs: Mapping[str, Any] | None = None,
        marks: Marks | None = None,
    ) -> None:
        """Make the last asked edit one undo step, as soon as its result is there.

        `kind` and `inputs` are what a project file remembers of it; `marks` is what the session's become with it.
        """
        if self._last is None:
            return
        self._title, self._kind, self._inputs, self._marks = title, kind, {**(inputs or {}), **self._how}, marks
        draft = self._session.document.draft
        if draft is not None and self._shown is self._last:
            self._commit(draft)

    @property
    def _how(self) -> dict[str, float]:
        return {} if self._wish is None else {"believability": self._wish.believability}

    def cancel(self) -> None:
        """Forget the edit under way."""
        self._last = self._title = None
        self._session.document.set_draft(None)

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
            self._dragger = editing.Dragger(request.take, request.controls, asked=request.asked)
        return request.verb(self._dragger)

    def _arrived(self, request: Request | None, patch: Patch | None) -> None:
        if request is None or patch is None:
            self.ready.emit()
            return
        if self._last is None or request.open is not self._session.document.take:
            return  # cancelled, or another take was opened meanwhile
        self.since, self._shown = request.since, request
        self._session.document.set_draft(patch)
        if self._title is not None and request is self._last:
            self._commit(patch)

    def _commit(self, patch: Patch) -> None:
        title, self._title, self._last = self._title, None, None
        step = EditCommand.of(
            self._session.document, patch, title or "edit", kind=self._kind, inputs=self._inputs, marks=self._marks
        )
        wish, self._wish = self._wish, None
        self._session.document.undo.push(step)
        if wish is not None:
            self._wishes.made(step, wish, start=patch.start, stop=patch.stop)

    def _refused(self, request: object, sentence: str, advice: str) -> None:
        self._last = self._title = None
        self._session.document.set_draft(None)
        self.failed.emit(sentence, advice)

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.READING):
            self._last = self._title = None
            self._wishes.forget()
        changed = self._wish is not None and self._wish.believability != self._session.view.believability
        if change & Change.TOOL and self.busy and self._curves is not None and changed:
            self.ask(*self._curves)
