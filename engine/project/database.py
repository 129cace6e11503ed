"""SQLite as project files use it: a file opened for one program alone, its errors as sentences, copies to read."""

from __future__ import annotations

import shutil
import sqlite3
import tempfile
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from engine.errors import EngineError, FormatError
from engine.formats.base.content import unread
from engine.formats.base.lock import InUseError
from engine.project import schema
from engine.project.blobs import DamagedError

MAX_BLOB_BYTES = 2**29
BESIDE = ("-wal", "-shm", "-journal")  # what SQLite lays beside a database
LOGS = ("-wal", "-journal")  # of these the ones that hold pages
LOG_HEADER_BYTES = 32  # of a log or journal; its salts change whenever it begins anew
COPIES = 20  # that are tried of a project that another program is writing
PAUSE_S = 0.05  # between them


@contextmanager
def sentences(name: str) -> Iterator[None]:
    """Turn what SQLite and the reader say into a sentence about the file."""
    try:
        yield
    except DamagedError as error:
        raise FormatError(f"{name} is damaged: {error}.", schema.DAMAGED) from error
    except UnicodeError as error:
        raise FormatError(f"{name} is damaged: a text in it cannot be read.", schema.DAMAGED) from error
    except sqlite3.Error as error:
        raise sentence_of(error, name) from error


def sentence_of(error: sqlite3.Error, name: str) -> EngineError:
    """Return what SQLite says as a sentence about a file."""
    kind = getattr(error, "sqlite_errorname", "") or ""
    if kind.startswith(("SQLITE_BUSY", "SQLITE_LOCKED")):
        return InUseError(f"{name} is open in another Retake.", "Close it there first.")
    if kind.startswith("SQLITE_FULL"):
        return EngineError(f"There is no room left on the disk for {name}.", "Make room; your work stays in memory.")
    if kind.startswith(("SQLITE_READONLY", "SQLITE_CANTOPEN", "SQLITE_IOERR", "SQLITE_PERM")):
        return EngineError(f"{name} could not be written: {error}.", "Choose another folder, or make room.")
    if kind.startswith("SQLITE_NOTADB"):
        return FormatError(f"{name} is not a Retake project.", schema.NOT_OURS)
    return FormatError(f"{name} is damaged.", schema.DAMAGED)


def connect(path: Path, name: str) -> sqlite3.Connection:
    """Open a database for one program alone, believing nothing that it says of itself."""
    with sentences(name):
        address = f"{path.absolute().as_uri()}?mode=rw"
        database = sqlite3.connect(address, uri=True, timeout=0, isolation_level=None, check_same_thread=False)
        database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MAX_BLOB_BYTES)
        database.execute("PRAGMA trusted_schema = OFF")
        database.execute("PRAGMA cell_size_check = ON")
        database.execute("PRAGMA locking_mode = EXCLUSIVE")
    return database


def keep_safe(database: sqlite3.Connection, name: str) -> None:
    """Let each step be in the file itself, and on the disk, when it is committed.

    A log written ahead (WAL) would flush once for each step, not four times (4 ms, not 16 ms, on a busy disk), but a
    copy of the file alone would lack what only the log has, and a log outlives a file that is replaced under it. The
    flushes are on a thread that nobody waits for.
    """
    with sentences(name):
        database.execute("PRAGMA journal_mode = DELETE").fetchone()
        database.execute("PRAGMA synchronous = FULL")


def scrap(path: Path) -> sqlite3.Connection:
    """Open an empty file to fill; what is cut short there is thrown away, so it needs no journal."""
    database = sqlite3.connect(path, isolation_level=None)
    database.execute("PRAGMA journal_mode = OFF")
    return database


def settle(path: Path, name: str) -> None:
    """Bring a database into its one file: what a killed program left of a step beside it is applied or undone."""
    with closing(connect(path, name)) as database, sentences(name):
        database.execute("SELECT count(*) FROM sqlite_master").fetchone()
        database.execute("PRAGMA journal_mode = DELETE").fetchone()


@contextmanager
def copied(path: Path, *, logs: bool = True) -> Iterator[Path]:
    """Give a copy in a folder that can be written, with the steps that only the log has unless it is left out.

    SQLite's own way to read beside a writer (mode=ro) makes files beside the database, which a folder that cannot be
    written refuses; and migrating an old version must not touch the file that was named.
    """
    with tempfile.TemporaryDirectory(prefix="retake") as folder:
        copy = Path(folder) / path.name
        try:
            _copy_unchanged(path.resolve(), copy, LOGS if logs else ())
        except OSError as error:
            raise unread(path, error) from error
        yield copy


def _copy_unchanged(path: Path, copy: Path, logs: tuple[str, ...]) -> None:
    """Copy a project and its log, again where another program wrote a step to the file meanwhile.

    Steps that are only added to the log do no harm: SQLite reads it up to its last whole step.
    """
    for _ in range(COPIES):
        before = _state_of(path)
        shutil.copyfile(path, copy)
        for ending in logs:
            beside = copy.with_name(copy.name + ending)
            try:
                shutil.copyfile(path.with_name(path.name + ending), beside)
            except FileNotFoundError:
                beside.unlink(missing_ok=True)
        if _state_of(path) == before:
            return
        time.sleep(PAUSE_S)
    raise InUseError(f"{path.name} is being written by another Retake.", "Try again in a moment.")


def _state_of(path: Path) -> tuple[object, ...]:
    """Return what changes whenever a database file is written, or its log or journal begun anew."""
    found = path.stat()
    heads = []
    for ending in LOGS:
        try:
            with path.with_name(path.name + ending).open("rb") as file:
                heads.append(file.read(LOG_HEADER_BYTES))
        except FileNotFoundError:
            heads.append(b"")
    return found.st_ino, found.st_size, found.st_mtime_ns, *heads
