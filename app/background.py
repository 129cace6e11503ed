"""Work off the GUI thread, latest wins: a newer request replaces the one still waiting."""

from __future__ import annotations

import logging
import sys
import threading
from collections.abc import Callable
from typing import Any

from PySide6.QtCore import QObject, QThread, Signal

from engine.errors import EngineError

SWITCH_S = 0.001  # after which a thread at work gives way to the window; Python's usual 5 ms are seen as a stall

log = logging.getLogger(__name__)


class LatestWins(QObject):
    """Runs `job(request)` on one thread of its own, always the same one.

    A finished result is always delivered, so that a drag shows steady progress; requests in between are skipped.

    Parameters
    ----------
    job : called on the thread; what it returns comes with `done`
    close : called last on the thread, to give back what the job made there
    """

    done = Signal(object, object)  # request, result
    failed = Signal(object, str, str)  # request, sentence, advice
    rested = Signal()  # nothing waits and nothing runs, and all results before were sent

    def __init__(self, job: Callable[[Any], Any], *, name: str, close: Callable[[], None] | None = None) -> None:
        super().__init__()
        sys.setswitchinterval(min(SWITCH_S, sys.getswitchinterval()))
        self._job, self._close = job, close
        self._wake = threading.Condition()
        self._waiting: dict[str, object] = {}  # by channel, oldest first
        self._working = self._stopping = False
        self._thread = _Thread(self._run)
        self._thread.setObjectName(name)
        self._thread.start()

    @property
    def idle(self) -> bool:
        """Whether nothing waits and nothing runs."""
        with self._wake:
            return not self._waiting and not self._working

    def submit(self, request: object, channel: str = "") -> None:
        """Ask for a request to be worked on; it replaces the one that waits in its channel, and no other."""
        with self._wake:
            self._waiting[channel] = request
            self._wake.notify_all()

    def finish(self, patience_s: float | None = None) -> bool:
        """Return when nothing waits and nothing runs, or patience ends; results are delivered later, as ever.

        Returns whether all is done; without a limit it always is.
        """
        with self._wake:
            return self._wake.wait_for(lambda: self._stopping or not (self._waiting or self._working), patience_s)

    def stop(self) -> None:
        """Finish the running job, then end the thread; returns when it has."""
        with self._wake:
            self._stopping = True
            self._wake.notify_all()
        self._thread.wait()

    def _run(self) -> None:
        while True:
            with self._wake:
                self._working = False
                self._wake.notify_all()
                if not self._waiting:
                    self.rested.emit()
                self._wake.wait_for(lambda: self._stopping or bool(self._waiting))
                if self._stopping:
                    break
                request, self._working = self._waiting.pop(next(iter(self._waiting))), True
            try:
                result = self._job(request)
            except EngineError as error:
                self.failed.emit(request, error.sentence, error.advice)
            except Exception as error:
                log.exception("background job failed")
                self.failed.emit(
                    request, f"Something went wrong: {error or type(error).__name__}.", "The log has more."
                )
            else:
                self.done.emit(request, result)
        if self._close:
            self._close()


class _Thread(QThread):
    def __init__(self, body: Callable[[], None]) -> None:
        super().__init__()
        self._body = body

    def run(self) -> None:
        self._body()
