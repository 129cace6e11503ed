"""The one way from a wish to an undo step: what is asked is worked out on a thread, latest wins; a result is kept."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, Signal

from app.background import LatestWins
from app.session.asked import Asked, Base
from app.session.changes import Change
from app.session.commands import EditCommand
from app.session.session import Session
from app.session.wishes import Wishes
from engine.editing import DragRequest, Editor, Request, warm_up
from engine.take import Array, Take

if TYPE_CHECKING:
    from engine.editing import Patch
    from engine.project import Marks

Tell = Callable[[float], None]


class Stopped(Exception):
    """Something else is wanted by now."""


class Runner(QObject):
    """Runs requests on one thread of its own; a newer request replaces the older one, and cancels it if it can.

    Parameters
    ----------
    session : whose take it is
    carry_out : called on the thread with a wish, and with what to tell the share done, 0..1

    Attributes
    ----------
    last : the last wish, until it is kept or dropped
    """

    arrived = Signal(object, object)  # an Asked, and what came of it
    progress = Signal(float)
    failed = Signal(str, str)  # sentence, advice
    ready = Signal()  # what `begin` began is done

    def __init__(self, session: Session, carry_out: Callable[[Asked, Tell], Any], *, name: str) -> None:
        super().__init__()
        self._session, self._carry_out = session, carry_out
        self.last: Asked | None = None
        self._work = LatestWins(self._run, name=name)
        self._work.done.connect(self._deliver)
        self._work.failed.connect(self._refused)

    @property
    def idle(self) -> bool:
        """Whether nothing is being worked out."""
        return self._work.idle

    def ask(self, asked: Asked) -> None:
        """Run a request; `arrived` or `failed` follows, unless another request replaces it."""
        self.last = asked
        self._work.submit((asked, self._session.document.take))

    def begin(self, prepare: Callable[[], None]) -> None:
        """Have something prepared on the thread; `ready` follows."""
        self._work.submit(prepare)

    def is_last(self, asked: Asked) -> bool:
        """Return whether a wish is the last one, perhaps by another title by now."""
        return self.last is not None and self.last.inputs is asked.inputs

    def drop(self) -> None:
        """Want nothing any more."""
        self.last = None

    def keep(self, asked: Asked, patch: Patch) -> EditCommand:
        """Make what came of a wish one undo step."""
        document = self._session.document
        step = EditCommand.of(document, patch, asked.title, kind=asked.verb, inputs=asked.stored, marks=asked.marks)
        self.drop()
        document.undo.push(step)
        return step

    def close(self) -> None:
        """End the thread."""
        self.drop()
        self._work.stop()

    def _run(self, request: tuple[Asked, Take] | Callable[[], None]) -> Any:
        if not isinstance(request, tuple):
            return request()
        asked, _ = request

        def tell(share: float) -> None:
            if not self.is_last(asked):
                raise Stopped
            self.progress.emit(share)

        try:
            return self._carry_out(asked, tell)
        except Stopped:
            return None

    def _deliver(self, request: tuple[Asked, Take] | Callable[[], None], result: Any) -> None:
        if not isinstance(request, tuple):
            self.ready.emit()
            return
        asked, take = request
        if result is not None and self.last is not None and take is self._session.document.take:
            self.arrived.emit(asked, result)

    def _refused(self, request: object, sentence: str, advice: str) -> None:
        self.drop()
        self.failed.emit(sentence, advice)


class Editing(QObject):
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
        self._editor: Editor | None = None
        self._shown: Asked | None = None  # what came of it is the draft
        self._curves: tuple[int, Array] | None = None  # what was asked of the controls, if anything was
        self._wishes = Wishes(session)
        self._runner = Runner(session, self._carry_out, name="inference")
        self._runner.arrived.connect(self._arrived)
        self._runner.failed.connect(self._refused)
        self._runner.ready.connect(self.ready)
        session.changed.connect(self._on_change)

    @property
    def busy(self) -> bool:
        """Whether an edit has a draft that is not kept yet."""
        return self._runner.last is not None

    @property
    def idle(self) -> bool:
        """Whether nothing is being worked out."""
        return self._runner.idle

    @property
    def since(self) -> float:
        """When the draft on screen was asked for."""
        return self._shown.since if self._shown is not None else 0.0

    def warm_up(self) -> None:
        """Load the networks, after the window shows, so that the first drag is as fast as the next."""
        self._runner.begin(warm_up)

    def ask(self, start: int, asked: Array) -> None:
        """Show what the face does for target curves, (n, 16), on the frames from `start`; NaN has no target."""
        if not self._finishing:
            base, request = self._wishes.asking(start, asked)
            self._curves = start, asked
            self._runner.ask(Asked(request.verb, request, base))

    def run(self, request: Request) -> None:
        """Show what a request comes to."""
        if not self._finishing:
            self._curves = None
            self._runner.ask(Asked(request.verb, request, Base.of(self._session.document)))

    @property
    def _finishing(self) -> bool:
        """Whether the edit before is being finished, which takes a few milliseconds."""
        return self._runner.last is not None and bool(self._runner.last.title)

    def finish(
        self,
        title: str,
        *,
        kind: str = "drag",
        inputs: Mapping[str, Any] | None = None,
        marks: Marks | None = None,
    ) -> None:
        """Make the last asked edit one undo step, as soon as its result is there.

        `kind` is what a project file calls it, `inputs` what it remembers beside the request; `marks` is what the
        session's become with it.
        """
        if self._runner.last is None:
            return
        asked = replace(self._runner.last, verb=kind, title=title, also=inputs or {}, marks=marks)
        self._runner.last = asked
        draft = self._session.document.draft
        if draft is not None and self._shown is not None and self._runner.is_last(self._shown):
            self._keep(asked, draft)

    def cancel(self) -> None:
        """Forget the current edit."""
        self._runner.drop()
        self._session.document.set_draft(None)

    def close(self) -> None:
        """End the thread."""
        self._runner.close()

    def _carry_out(self, asked: Asked, tell: Tell) -> Patch:
        assert isinstance(asked.of, Base)
        if self._editor is None or self._editor.take is not asked.of.take:
            self._editor = Editor(asked.of.take, asked.of.controls, asked=asked.of.asked)
        return self._editor.patch(asked.inputs)

    def _arrived(self, asked: Asked, patch: Patch) -> None:
        self._shown = asked
        self._session.document.set_draft(patch)
        last = self._runner.last
        if last is not None and last.title and self._runner.is_last(asked):
            self._keep(last, patch)

    def _keep(self, asked: Asked, patch: Patch) -> None:
        step = self._runner.keep(asked, patch)
        if isinstance(asked.inputs, DragRequest):
            assert isinstance(asked.of, Base)
            self._wishes.kept(step, asked.of, asked.inputs, start=patch.start, stop=patch.stop)

    def _refused(self, sentence: str, advice: str) -> None:
        self._session.document.set_draft(None)
        self.failed.emit(sentence, advice)

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.READING):
            self._runner.drop()
            self._wishes.forget()
        if change & Change.TOOL and self._runner.last is not None and self._curves is not None:
            request = self._runner.last.inputs
            if isinstance(request, DragRequest) and request.believability != self._session.view.believability:
                self.ask(*self._curves)
