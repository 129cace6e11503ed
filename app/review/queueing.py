"""Reads a folder of pairs, and makes the project of one, on a thread of their own."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from app.background import LatestWins
from app.session import Change, Session
from engine.project import Verdict
from engine.review.queue import Entry, begun, entries, next_open


@dataclass(frozen=True)
class _Begin:
    """A pair whose project is wanted."""

    place: int
    entry: Entry


class Queueing(QObject):
    """The queue that is open, and which of its pairs is on the screen.

    Parameters
    ----------
    session : what is open, and its verdict

    Attributes
    ----------
    queue : the pairs, each with the verdict that is known of it
    current : the place of the pair that is open; None where it is none of them
    """

    changed = Signal()
    ready = Signal(object)  # the path of a project to open
    failed = Signal(str, str)  # sentence, advice

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.queue: tuple[Entry, ...] = ()
        self.current: int | None = None
        self._work = LatestWins(_carry_out, name="queue")
        self._work.done.connect(self._arrived)
        self._work.failed.connect(self._refused)
        session.changed.connect(self._on_change)

    @property
    def idle(self) -> bool:
        """Whether nothing is being read."""
        return self._work.idle

    def open(self, folder: Path) -> None:
        """Read a folder of pairs; its first pair without a verdict is opened."""
        self._work.submit(folder)

    def go_to(self, place: int) -> None:
        """Open a pair, `ready` follows; one that cannot be read leaves what is open as it is."""
        if 0 <= place < len(self.queue):
            self._work.submit(_Begin(place, self.queue[place]))

    def step(self, by: int) -> None:
        """Open the next pair or the one before; where none of them is open, the first without a verdict."""
        if not self.queue:
            self.failed.emit("No queue is open.", "Open a folder of pairs with Review, Open a folder of pairs.")
        elif self.current is None:
            self.go_to(next_open(self.queue))
        elif 0 <= self.current + by < len(self.queue):
            self.go_to(self.current + by)
        else:
            self.failed.emit(f"This is the {'last' if by > 0 else 'first'} pair of the queue.", "")

    def close(self) -> None:
        """End the thread."""
        self._session.changed.disconnect(self._on_change)
        self._work.stop()

    def _arrived(self, request: Path | _Begin, result: object) -> None:
        if isinstance(request, _Begin):
            if request.place < len(self.queue) and self.queue[request.place].after == request.entry.after:
                self._put(request.place, replace(self.queue[request.place], trouble=""))
                self.ready.emit(result)
        else:
            assert isinstance(result, tuple)
            self.queue, self.current = result, None
            self.changed.emit()
            self.go_to(next_open(self.queue))

    def _refused(self, request: Path | _Begin, sentence: str, advice: str) -> None:
        self.failed.emit(sentence, advice)
        if isinstance(request, _Begin) and request.place < len(self.queue):
            self._put(request.place, replace(self.queue[request.place], trouble=sentence))

    def _put(self, place: int, entry: Entry) -> None:
        if self.queue[place] != entry:
            self.queue = (*self.queue[:place], entry, *self.queue[place + 1 :])
            self.changed.emit()

    def _on_change(self, change: Change) -> None:
        """Know which pair is open, and what its verdict is by now."""
        if not self.queue or not change & (Change.TAKE | Change.MARKS | Change.SAVED):
            return
        path = self._session.document.path
        found = next((place for place, entry in enumerate(self.queue) if entry.review == path), None)
        if found != self.current:
            self.current = found
            self.changed.emit()
        if found is not None:
            verdicts = self._session.document.marks.verdicts
            verdict: Verdict | None = verdicts[-1] if verdicts and verdicts[-1].judgement else None
            self._put(found, replace(self.queue[found], verdict=verdict))


def _carry_out(request: Path | _Begin) -> object:
    return begun(request.entry) if isinstance(request, _Begin) else entries(request)
