"""A recording of a stream: it grows in a file while it is made, and in memory alone where no file can be written."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from engine.errors import EngineError

if TYPE_CHECKING:
    from engine.live.record import Recorder
    from engine.live.spool import Spool
    from engine.project import Contents
    from engine.take import Take


class Recording(QObject):
    """Records one take after another.

    Parameters
    ----------
    folder : where a recording grows while it is made, so that a crash does not lose it
    """

    recorded = Signal(object)  # a Take
    failed = Signal(str, str)  # sentence, advice

    def __init__(self, folder: Path) -> None:
        super().__init__()
        self._folder = folder
        self._recorder: Recorder | None = None
        self._spool: Spool | None = None
        self._waiting: Take | None = None  # a recording that is not open yet
        self._unsafe: tuple[Take, Spool | None] | None = None  # one that no other file holds yet
        self._told = ""  # once is enough, until it works again

    @property
    def running(self) -> bool:
        """Whether frames are recorded."""
        return self._recorder is not None

    @property
    def frames(self) -> int:
        """How many were recorded so far."""
        return len(self._recorder) if self._recorder is not None else 0

    def begin(self) -> Recorder:
        """Begin a recording; returns what takes its frames."""
        from engine.live.record import Recorder
        from engine.live.spool import Spool

        self._recorder = recorder = Recorder()
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            self._spool = Spool(recorder, self._folder / "live.csv")
        except (EngineError, OSError) as error:  # it goes on in memory
            self.failed.emit(f"A crash would lose this recording: {error}", "")
        return recorder

    def end(self) -> None:
        """End the recording; `recorded` or `failed` follows."""
        recorder, self._recorder = self._recorder, None
        if recorder is None:
            return
        try:
            take = recorder.take("live")
        except EngineError as error:
            self.failed.emit(error.sentence, error.advice)
            self._close_spool(remove=True)
            return
        self.save(all_rows=True)
        self._waiting, self._unsafe, self._spool = take, (take, self._spool), None
        self.recorded.emit(take)
        if self._waiting is not None:
            self.failed.emit("The recording waits until your edits are safe.", "Else it is offered at the next start.")

    def save(self, *, all_rows: bool = False) -> None:
        """Write the new frames; an error is reported once, until writing works again."""
        if self._spool is None:
            return
        try:
            self._spool.save(all_rows=all_rows)
            self._told = ""
        except EngineError as error:
            if error.sentence != self._told:
                self._told = error.sentence
                self.failed.emit(error.sentence, f"The recording goes on in memory. {error.advice}")

    def opened(self, take: Take) -> None:
        """Take note that a take was opened: the recording waits no longer where it is that one."""
        if take is self._waiting:
            self._waiting = None

    def settle(self, kept: Contents) -> None:
        """Remove the growing file of a recording that another file holds by now: the one with these contents."""
        if self._unsafe is not None and self._unsafe[0] is kept.original:
            spool, self._unsafe = self._unsafe[1], None
            if spool is not None:
                spool.close(remove=True)

    def shut_down(self) -> None:
        """Leave a recording under way on disk, where it is offered at the next start."""
        if self._recorder is not None:
            self.save(all_rows=True)
            self._recorder = None
        self._close_spool(remove=False)
        if self._unsafe is not None and self._unsafe[1] is not None:
            self._unsafe[1].close(remove=False)

    def _close_spool(self, *, remove: bool) -> None:
        if self._spool is not None:
            self._spool.close(remove=remove)
            self._spool = None
