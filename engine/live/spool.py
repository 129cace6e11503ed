"""A recording on disk while it is made: what a crash leaves is a take that opens, short of its last moments."""

from __future__ import annotations

import itertools
import os
from pathlib import Path
from typing import BinaryIO

import numpy as np

from engine.errors import EngineError
from engine.formats import livelink
from engine.live.record import Recorder
from engine.take import SHAPES, Array

SETTLED_S = 1.0  # no packet comes later than this behind another; rows must stand in the order of time


class Spool:
    """Appends what a recorder keeps to a Live Link Face CSV beside the file that the recording will become.

    Attributes
    ----------
    path : of the growing file
    failed : whether it could not be written any more

    Parameters
    ----------
    recorder : asked for what is new
    target : where the recording will be written; `take.csv` gives `take.partial.csv`

    Raises
    ------
    EngineError : when the file cannot be made
    """

    def __init__(self, recorder: Recorder, target: Path) -> None:
        self._recorder = recorder
        self._taken, self._first_s, self._last_s = 0, np.nan, -np.inf
        self.failed = False
        self._held: Array = recorder.since(0)
        self.path, self._file = _made(target)
        self._append(livelink.header())

    def save(self, *, all_rows: bool = False) -> None:
        """Write what is settled by now, or all of it; raises `EngineError` where the disk is full.

        Lines are written whole or not at all, so that the file opens whenever the program ends.
        """
        os.utime(self.path)  # whoever finds the file sees that it is being written, even while no face comes
        new = self._recorder.since(self._taken)
        self._taken += len(new)
        held = np.concatenate([self._held, new])
        held = held[np.argsort(held[:, 0], kind="stable")]
        settled_s = held[-1, 0] - (0.0 if all_rows else SETTLED_S) if len(held) else 0.0
        ready, self._held = held[held[:, 0] <= settled_s], held[held[:, 0] > settled_s]
        ready = ready[np.diff(ready[:, 0], prepend=self._last_s) > 0]
        if len(ready):
            self._last_s = float(ready[-1, 0])
            if np.isnan(self._first_s):  # what came late before the stream's first packet would have no timecode
                self._first_s = float(ready[0, 0])
            lost = np.isnan(ready[:, 2])
            weights, rotations = np.nan_to_num(ready[:, 2 : 2 + len(SHAPES)]), ready[:, 2 + len(SHAPES) :]
            self._append(b"".join(livelink.rows(ready[:, 0] - self._first_s, weights, rotations, lost)))

    def close(self, *, remove: bool) -> None:
        """Close the file; `remove` when the recording is safe elsewhere."""
        self._file.close()
        if remove:
            self.path.unlink(missing_ok=True)

    def _append(self, lines: bytes) -> None:
        whole = self._file.tell()
        try:
            written = 0
            while written < len(lines):
                written += self._file.write(lines[written:])
        except OSError as error:
            self.failed = True
            self._file.truncate(whole)
            self._file.seek(whole)
            reason = (error.strerror or "unknown reason").lower()
            raise EngineError(f"{self.path.name} cannot be written: {reason}.", "Make room on the disk.") from error


def _made(target: Path) -> tuple[Path, BinaryIO]:
    """Make the file under the first name that is free, lest what an earlier crash left is lost."""
    for number in itertools.count(1):
        path = target.with_name(f"{target.stem}.partial{'' if number == 1 else number}.csv")
        try:
            return path, path.open("xb", buffering=0)
        except FileExistsError:
            continue
        except OSError as error:
            reason = (error.strerror or "unknown reason").lower()
            raise EngineError(f"{path.name} cannot be written: {reason}.", "Choose another folder.") from error
    raise AssertionError("names do not end")
