"""Writes a recording to disk while it runs, so that a crash leaves a take that opens, without its last moments."""

from __future__ import annotations

import itertools
import os
import threading
import time
from pathlib import Path
from typing import BinaryIO

import numpy as np

from engine.errors import EngineError, FormatError
from engine.formats import livelink
from engine.formats.base.atomic import sync_folder
from engine.formats.base.content import content_of
from engine.formats.base.lock import FileLock, InUseError
from engine.formats.base.reading import Reading
from engine.formats.base.unfinished import whole_rows
from engine.live.record import Recorder
from engine.take import SHAPES, Array, Take

SETTLED_S = 1.0  # no packet comes later than this behind another; rows must stand in the order of time
AS_SPOOLED = Reading(sides="recorded")  # it is written as the app does, whatever its motion looks like
SYNC_S = 1.0  # of a recording that a power cut may take


class Spool:
    """Appends what a recorder keeps to a Live Link Face CSV beside the file that the recording will become.

    Whoever finds the file knows by its lock whether it is still written, however long nothing comes. One that vanishes
    or is replaced is written anew, from the beginning. It is brought to the disk once a second, on a thread of its own.

    Attributes
    ----------
    path : of the growing file
    failed : whether it could not be written the last time; the next `save` brings what is missing

    Parameters
    ----------
    recorder : polled for new arrivals
    target : where the recording will be written; `take.csv` gives `take.partial.csv`

    Raises
    ------
    EngineError : when the file cannot be created
    """

    def __init__(self, recorder: Recorder, target: Path) -> None:
        self._recorder, self._target = recorder, target
        self.failed = False
        self._syncing: threading.Thread | None = None
        self._begin()

    def save(self, *, all_rows: bool = False) -> None:
        """Write what is settled by now, or all of it; raises `EngineError` where the disk is full.

        Lines are written whole or not at all, so that the file opens whenever the program ends.
        """
        try:
            if not self._in_place():
                self._close()
                self._begin()
            self._write(settled_s=0.0 if all_rows else SETTLED_S)
            self._sync(wait=all_rows)
        except (EngineError, OSError) as error:
            self.failed = True
            if isinstance(error, EngineError):
                raise
            raise _unwritten(self.path, error) from error
        self.failed = False

    def close(self, *, remove: bool) -> None:
        """Close the file; `remove` when the recording is safe elsewhere."""
        if remove and self._in_place():
            self.path.unlink(missing_ok=True)
        self._close()

    def _begin(self) -> None:
        """Begin a file under the first name that is free, lest what an earlier crash left is lost."""
        self._taken, self._first_s, self._last_s = 0, np.nan, -np.inf
        self._held: Array = self._recorder.since(0)[:0]
        self._synced_s = time.monotonic()
        self.path, self._file, self._lock = _made(self._target)
        self._append(livelink.header())
        sync_folder(self.path.parent)

    def _close(self) -> None:
        if self._syncing is not None:
            self._syncing.join()
        self._file.close()
        self._lock.release()

    def _in_place(self) -> bool:
        try:
            return os.path.samestat(os.stat(self.path), os.fstat(self._file.fileno()))
        except (OSError, ValueError):  # a closed file has no descriptor
            return False

    def _write(self, *, settled_s: float) -> None:
        """Append the rows that are at least so old; where that fails the next call tries them again."""
        new = self._recorder.since(self._taken)
        pending = np.concatenate([self._held, new])
        pending = pending[np.argsort(pending[:, 0], kind="stable")]
        until_s = pending[-1, 0] - settled_s if len(pending) else 0.0
        ready, rest = pending[pending[:, 0] <= until_s], pending[pending[:, 0] > until_s]
        ready = ready[np.diff(ready[:, 0], prepend=self._last_s) > 0]
        if len(ready):  # what came late before the stream's first packet would have no timecode
            first_s = float(ready[0, 0]) if np.isnan(self._first_s) else self._first_s
            lost = np.isnan(ready[:, 2])
            weights, rotations = np.nan_to_num(ready[:, 2 : 2 + len(SHAPES)]), ready[:, 2 + len(SHAPES) :]
            self._append(b"".join(livelink.rows(ready[:, 0] - first_s, weights, rotations, lost)))
            self._first_s, self._last_s = first_s, float(ready[-1, 0])
        self._taken, self._held = self._taken + len(new), rest

    def _append(self, lines: bytes) -> None:
        whole = self._file.tell()
        try:
            written = 0
            while written < len(lines):
                written += self._file.write(lines[written:])
        except OSError as error:
            self._file.truncate(whole)
            self._file.seek(whole)
            raise _unwritten(self.path, error) from error

    def _sync(self, *, wait: bool) -> None:
        """Bring the file to the disk: now, or, once a second, beside the window."""
        if wait:
            os.fsync(self._file.fileno())
        elif time.monotonic() - self._synced_s >= SYNC_S and not (self._syncing and self._syncing.is_alive()):
            self._synced_s = time.monotonic()
            self._syncing = threading.Thread(target=_synced, args=(self._file.fileno(),), daemon=True)
            self._syncing.start()


def recovered(path: Path) -> Take | None:
    """Return what a recording that was cut short holds, up to its last whole row; None where no face was recorded.

    Raises `FormatError` where it is no recording.
    """
    content = content_of(path)
    rows = whole_rows(content).split(b"\n")[1:]
    if any(row.count(b",") > 1 for row in rows):
        return livelink.read(path, reading=AS_SPOOLED)
    if not content.startswith(livelink.header()[: len(content)]):
        raise FormatError(f"{path.name} is no recording.")
    return None


def _synced(descriptor: int) -> None:
    try:
        os.fsync(descriptor)
    except OSError:  # the next write meets it too, and tells
        return


def _made(target: Path) -> tuple[Path, BinaryIO, FileLock]:
    for number in itertools.count(1):
        path = target.with_name(f"{target.stem}.partial{'' if number == 1 else number}.csv")
        try:
            lock = FileLock(path)
        except InUseError:
            continue
        except OSError as error:
            raise _unwritten(path, error) from error
        try:
            return path, path.open("xb", buffering=0), lock
        except FileExistsError:
            lock.release()
        except OSError as error:
            lock.release()
            raise _unwritten(path, error) from error
    raise AssertionError("names do not end")


def _unwritten(path: Path, error: OSError) -> EngineError:
    reason = (error.strerror or "unknown reason").lower()
    return EngineError(f"{path.name} cannot be written: {reason}.", "Make room on the disk, or choose another folder.")
