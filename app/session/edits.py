"""The one way from a wish to an undo step: what is asked is worked out on a thread, latest wins; a result is kept."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, Signal

from app.background import LatestWins
from app.session.commands import EditCommand
from app.session.session import Session
from engine.editing import Request
from engine.take import Array, Take

if TYPE_CHECKING:
    from engine.editing import LabelRequest, Patch, Performance, RetargetRequest
    from engine.project import Marks

LARGEST_KEPT = 1 << 16  # characters of arrays that a step keeps; a project that is opened sets memory aside for each
Tell = Callable[[float], None]


class Stopped(Exception):
    """Something else is wanted by now."""


@dataclass(frozen=True, eq=False)
class Base:
    """A take that something is asked of.

    Attributes
    ----------
    take : as the edits below left it
    controls : (frames, 16) measured on it
    asked : (frames, 16) what those edits asked for, NaN where nothing
    """

    take: Take
    controls: Array
    asked: Array


@dataclass(frozen=True, eq=False)
class Asked:
    """A wish of the user.

    Attributes
    ----------
    verb : what the step is, as a project file names it
    inputs : all that it takes to carry it out again
    of : what it is asked of
    title : what the user did, as the Undo menu shows it; empty while a gesture lasts
    marks : what the session's marks become with it, if anything
    also : what else a project file remembers of it
    variants : how many ways of doing it are wanted
    since : when the user asked, on the clock of `time.perf_counter`
    """

    verb: str
    inputs: Request | RetargetRequest | LabelRequest
    of: Base | Performance
    title: str = ""
    marks: Marks | None = None
    also: Mapping[str, Any] = field(default_factory=dict)
    variants: int = 1
    since: float = field(default_factory=time.perf_counter)

    @property
    def frames(self) -> tuple[int, int]:
        """The frames that it is about, half-open."""
        return self.inputs.frames or (0, len(self.of.take))

    @property
    def stored(self) -> dict[str, Any]:
        """What a project file keeps, so that it can be done again; without the inputs where they are very large."""
        inputs = self.inputs.stored()
        if _length(inputs) > LARGEST_KEPT:
            inputs = {name: value for name, value in inputs.items() if not _length(value)}
        return {**self.also, "request": self.inputs.verb, **inputs}


def _length(stored: Any) -> int:
    """Return how many characters the packed arrays among an edit's inputs take."""
    if isinstance(stored, Mapping):
        return len(stored["f8"]) if "f8" in stored else sum(_length(value) for value in stored.values())
    return 0


class Runner(QObject):
    """Carries out what is asked on one thread of its own; newer wishes replace older ones, and stop them if they can.

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
        """Have a wish carried out; `arrived` or `failed` follows, unless another wish does."""
        self.last = asked
        self._work.submit((asked, self._session.document.take))

    def is_last(self, asked: Asked) -> bool:
        """Return whether a wish is the last one, perhaps by another title by now."""
        return self.last is not None and self.last.inputs is asked.inputs

    def drop(self) -> None:
        """Want nothing any more."""
        self.last = None

    def keep(self, asked: Asked, patch: Patch) -> EditCommand:
        """Make what came of a wish one undo step."""
        inputs, session = asked.stored, self._session
        step = EditCommand.of(session.document, patch, asked.title, kind=asked.verb, inputs=inputs, marks=asked.marks)
        self.drop()
        session.document.undo.push(step)
        return step

    def close(self) -> None:
        """End the thread."""
        self.drop()
        self._work.stop()

    def _run(self, request: tuple[Asked, Take]) -> Any:
        asked = request[0]

        def tell(share: float) -> None:
            if not self.is_last(asked):
                raise Stopped
            self.progress.emit(share)

        try:
            return self._carry_out(asked, tell)
        except Stopped:
            return None

    def _deliver(self, request: tuple[Asked, Take], result: Any) -> None:
        asked, take = request
        if result is not None and self.last is not None and take is self._session.document.take:
            self.arrived.emit(asked, result)

    def _refused(self, request: object, sentence: str, advice: str) -> None:
        self.drop()
        self.failed.emit(sentence, advice)
