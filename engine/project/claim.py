"""The right to write a project file, and the knowledge whether it is still the file that was opened."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from engine.errors import EngineError
from engine.formats.base.lock import FileLock
from engine.formats.base.owner import boot_mark

HEAD_BYTES = 1 << 16  # of a database file: the roots of all tables, one of which each step writes, lie in them
JOURNALS = ("-journal", "-wal")  # what SQLite would apply to the file beside it
RESCUED = "Your work is kept as unsaved work; save it under another name."


class DisplacedError(EngineError):
    """The file that was open is no more at its path: moved, deleted, replaced, or written by another program."""


class Claim:
    """A lock on a project file, a descriptor of it, and a record of what it holds.

    The descriptor stays open until the database is closed: closing any descriptor of a file would drop SQLite's own
    locks on it. The record, a hidden file beside the project, says what the file held when no step was being written,
    so that a journal which a killed program left is never applied to a file that took the place of the one it was for.

    Parameters
    ----------
    path : of the project; a link is followed

    Raises
    ------
    InUseError : where another program has it
    OSError : where no lock can be made
    """

    def __init__(self, path: Path) -> None:
        self.path = path.resolve()
        self.record = self.path.with_name(f".{self.path.name[:200]}.open")
        self._lock = FileLock(self.path)
        self._file: int | None = None
        self._written = (0, 0)
        self._head = ""

    def shed_foreign_journal(self, whole: Callable[[Path], bool], rolled_back: Callable[[Path, Path], str]) -> None:
        """Remove a journal that is done with, or not the present file's; `whole` says whether a file is so without it.

        `rolled_back` returns the head of a file as a journal would restore it.
        """
        for journal in (self.path.with_name(self.path.name + ending) for ending in JOURNALS):
            if not (is_hot(journal) and belongs(journal, self.path, self.record, whole, rolled_back)):
                journal.unlink(missing_ok=True)

    def begin(self) -> None:
        """Open the descriptor, before SQLite opens the file."""
        self._file = os.open(self.path, os.O_RDONLY | getattr(os, "O_BINARY", 0))

    def note(self) -> None:
        """Remember what the file holds now that a step is written."""
        assert self._file is not None
        self._written, self._head = _state(self._file), head_of(self._file)
        with suppress(OSError):  # without it a journal is believed, as SQLite does
            self.record.write_text(f"{self._head} {boot_mark()}")

    def check(self, name: str) -> None:
        """Raise `DisplacedError` where a step would go to a file that is no more the one that was opened."""
        assert self._file is not None
        try:
            found = os.stat(self.path)
        except (FileNotFoundError, NotADirectoryError) as error:
            raise DisplacedError(f"{name} was moved or deleted.", RESCUED) from error
        except OSError as error:
            reason = (error.strerror or "unknown reason").lower()
            raise EngineError(f"{name} cannot be reached: {reason}.", "Your work stays in memory.") from error
        if not os.path.samestat(found, os.fstat(self._file)):
            raise DisplacedError(f"{name} was replaced by another program.", RESCUED)
        if not self._lock.held:
            raise DisplacedError(f"{name} was opened on another computer meanwhile.", RESCUED)
        if _state(self._file) != self._written and head_of(self._file) != self._head:
            raise DisplacedError(f"{name} was changed by another program.", RESCUED)

    def is_ours(self) -> bool:
        """Return whether what lies at the path, and beside it, is this program's."""
        try:
            self.check(self.path.name)
        except EngineError:
            return False
        return True

    def release(self) -> None:
        """Let others have the file; the database is closed by now."""
        if self._file is not None:
            os.close(self._file)
            self._file = None
        if self._lock.held:
            with suppress(OSError):
                self.record.unlink(missing_ok=True)
        self._lock.release()


def is_hot(journal: Path) -> bool:
    """Return whether SQLite would apply a journal: one that is done with is empty, or its header is zeroed."""
    try:
        with journal.open("rb") as file:
            return file.read(1) not in (b"", b"\0")
    except OSError:
        return False


def belongs(
    journal: Path,
    path: Path,
    record: Path,
    whole: Callable[[Path], bool],
    rolled_back: Callable[[Path, Path], str],
) -> bool:
    """Return whether a journal is of the very file at a path, by the record that its writer left.

    Where there is no record, or the computer was started anew since (which may have lost its last version), only a
    file that cannot be read without the journal proves it, and otherwise the journal is believed.
    """
    try:
        head, boot = record.read_text().split()
    except (OSError, ValueError):
        return True
    if boot != boot_mark() or rolled_back(path, journal) == head:
        return True
    return not whole(path)


def head_of(file: int) -> str:
    """Return a text that two states of a database file share only where no step lies between them."""
    os.lseek(file, 0, os.SEEK_SET)
    head = os.read(file, HEAD_BYTES)
    return hashlib.sha256(head + str(os.fstat(file).st_size).encode()).hexdigest()


def _state(file: int) -> tuple[int, int]:
    found = os.fstat(file)
    return found.st_size, found.st_mtime_ns
