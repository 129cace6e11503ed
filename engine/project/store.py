"""Project files on disk: made whole or not at all, brought up to date by one transaction for each finished step."""

from __future__ import annotations

import os
import shutil
import sqlite3
import tempfile
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path

from engine.errors import EngineError, FormatError
from engine.formats.atomic import replacement
from engine.formats.content import require_file
from engine.project import held, rows, schema
from engine.project.blobs import Budget, DamagedError
from engine.project.records import Contents, Summary

ENDING = ".retake"
MAX_BLOB_BYTES = 2**29
MAX_FILE_BYTES = 2**36
BESIDE = ("-wal", "-shm", "-journal")  # what SQLite lays beside a database
STEP_PAGES = 512  # that are copied at a time, 2 MiB

Report = Callable[[float], None]  # the share that is done, 0 to 1; an `EngineError` raised by it stops the work


class InUseError(EngineError):
    """Another running program, or another window, has the project open."""


class Project:
    """An open project file, locked against other programs for as long as it is open.

    The log is written ahead (WAL) and flushed at each step (synchronous=FULL): a kill loses nothing that `put` has
    returned from, and neither does a power cut. The flush takes milliseconds, on a thread that nobody waits for.
    """

    def __init__(self, path: Path, contents: Contents, database: sqlite3.Connection | None) -> None:
        self.path = path
        self._contents = contents
        self._database = database
        self._held = held.hold(path) if database is not None else None

    @classmethod
    def open(cls, path: Path) -> Project:
        """Open a project; one that cannot be written is read, and refuses `put`.

        Raises `FormatError` for a file that is damaged or no project, `InUseError` for one that is open elsewhere.
        """
        require_file(path, at_most=MAX_FILE_BYTES)
        if not (os.access(path, os.W_OK) and os.access(path.parent, os.W_OK)):
            with _copied(path) as copy, closing(_connect(copy, path.name)) as database:
                return cls(path, _read(database, path), None)
        database = _connect(path, path.name)
        try:
            contents = _read(database, path)
            with sentences(path.name):
                database.execute("PRAGMA journal_mode = WAL")
                database.execute("PRAGMA synchronous = FULL")
        except BaseException:
            database.close()
            raise
        return cls(path, contents, database)

    @property
    def contents(self) -> Contents:
        """What is safe in the file."""
        return self._contents

    @property
    def read_only(self) -> bool:
        """Whether the file or its folder cannot be written."""
        return self._database is None

    def put(self, contents: Contents) -> None:
        """Bring the file to these contents, which share the original take, in one transaction.

        What is the same object as before is not written again. Raises `EngineError` where it cannot be written; the
        file then is as it was, and the next `put` writes all that is missing.
        """
        old = self._contents
        if contents.original is not old.original:
            raise ValueError("these contents belong to another project")
        same = 0
        while same < min(len(old.edits), len(contents.edits)) and old.edits[same] is contents.edits[same]:
            same += 1
        with self._transaction() as database:
            rows.write_edits(database, same, contents.edits[same:])
            if contents.marks != old.marks:
                rows.write_marks(database, contents.marks)
            rows.write_state(database, contents)
        self._contents = contents

    def save_as(self, path: Path, report: Report = lambda _: None) -> Project:
        """Copy the file to a path and open the copy; what was at the path stays there, whole, until the copy is.

        `report` may `put` further contents: SQLite brings them to the part that is copied already, until all is.
        """
        database = self._writable()
        if path.exists() and path.samefile(self.path):
            return self
        _settle(path)
        with sentences(path.name), replacement(path) as temporary, closing(_scrap(temporary)) as copy:
            copied = self._contents

            def step(_: int, left: int, pages: int) -> None:
                nonlocal copied
                copied = self._contents  # what is put after the last step is in the old file alone
                report(1 - left / max(1, pages))

            database.backup(copy, pages=STEP_PAGES, progress=step)
            copy.close()
        return _attach(path, copied)

    def close(self) -> None:
        """Let go of the file."""
        if self._database is not None:
            self._database.close()
            self._database = None
            held.let_go(self._held)

    def _writable(self) -> sqlite3.Connection:
        if self._database is None:
            raise EngineError(f"{self.path.name} cannot be written.", "Save it under another name.")
        if not self.path.exists():
            raise EngineError(f"{self.path.name} was moved or deleted.", "Save your work under a new name.")
        return self._database

    @contextmanager
    def _transaction(self) -> Iterator[sqlite3.Connection]:
        database = self._writable()
        with sentences(self.path.name):
            database.execute("BEGIN IMMEDIATE")
            try:
                yield database
                database.execute("COMMIT")
            except BaseException:
                if database.in_transaction:
                    database.execute("ROLLBACK")
                raise


def create(path: Path, contents: Contents, report: Report = lambda _: None) -> Project:
    """Make a project file and open it; a file that is there already is replaced whole or left as it was."""
    _settle(path)
    with sentences(path.name), replacement(path) as temporary, closing(_scrap(temporary)) as database:
        database.execute("BEGIN")
        schema.build(database)
        rows.write_contents(database, contents, report)
        database.execute("COMMIT")
        database.close()
        report(1.0)
    return _attach(path, contents)


def peek(path: Path) -> Summary:
    """Return what a project is; raises as `Project.open` does."""
    with sentences(path.name), closing(_connect(path, path.name)) as database:
        schema.migrate(database, schema.check(database, path.name))
        return rows.read_summary(database)


def delete(path: Path) -> None:
    """Remove a project and what lies beside it; raises `InUseError` when it is open elsewhere."""
    with suppress(FormatError), closing(_connect(path, path.name)) as database, sentences(path.name):
        database.execute("SELECT count(*) FROM sqlite_master").fetchone()
    path.unlink(missing_ok=True)
    _clear_beside(path)


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
        raise _told(error, name) from error


def _told(error: sqlite3.Error, name: str) -> EngineError:
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


def _connect(path: Path, name: str) -> sqlite3.Connection:
    """Open a database for one program alone, believing nothing that it says of itself."""
    with sentences(name):
        address = f"{path.absolute().as_uri()}?mode=rw"
        database = sqlite3.connect(address, uri=True, timeout=0, isolation_level=None, check_same_thread=False)
        database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MAX_BLOB_BYTES)
        database.execute("PRAGMA trusted_schema = OFF")
        database.execute("PRAGMA cell_size_check = ON")
        database.execute("PRAGMA locking_mode = EXCLUSIVE")
    return database


def _scrap(path: Path) -> sqlite3.Connection:
    """Open an empty file to fill; what is cut short there is thrown away, so it needs no journal."""
    database = sqlite3.connect(path, isolation_level=None)
    database.execute("PRAGMA journal_mode = OFF")
    return database


def _read(database: sqlite3.Connection, path: Path) -> Contents:
    with sentences(path.name):
        schema.migrate(database, schema.check(database, path.name))
        log = path.with_name(f"{path.name}-wal")
        held = path.stat().st_size + (log.stat().st_size if log.exists() else 0)
        return rows.read_contents(database, Budget(held))


def _attach(path: Path, contents: Contents) -> Project:
    """Open a file that has just been written, without reading it again."""
    database = _connect(path, path.name)
    with sentences(path.name):
        database.execute("PRAGMA journal_mode = WAL")
        database.execute("PRAGMA synchronous = FULL")
    return Project(path, contents, database)


def _settle(path: Path) -> None:
    """Bring a project that is about to be replaced into its one file, since its log must not meet the new one."""
    if path.is_file():
        try:
            with closing(_connect(path, path.name)) as database, sentences(path.name):
                database.execute("SELECT count(*) FROM sqlite_master").fetchone()
                database.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()
        except FormatError:
            if path.with_name(f"{path.name}-wal").exists():
                raise  # a damaged project with its last steps beside it: whatever can be saved of it is kept
            return
    _clear_beside(path)


def _clear_beside(path: Path) -> None:
    try:
        for ending in BESIDE:
            path.with_name(path.name + ending).unlink(missing_ok=True)
    except NotADirectoryError:
        return
    except OSError as error:
        reason = (error.strerror or "unknown reason").lower()
        raise EngineError(
            f"{path.name} could not be written: {reason}.", "Choose another folder, or make room."
        ) from error


@contextmanager
def _copied(path: Path) -> Iterator[Path]:
    """Give a copy in a folder that can be written, with the steps that only the log has."""
    with tempfile.TemporaryDirectory(prefix="retake") as folder:
        copy = Path(folder) / path.name
        try:
            shutil.copyfile(path, copy)
            log = path.with_name(f"{path.name}-wal")
            if log.is_file():
                shutil.copyfile(log, copy.with_name(log.name))
        except OSError as error:
            reason = (error.strerror or "unknown reason").lower()
            raise FormatError(f"{path.name} could not be read: {reason}.") from error
        yield copy
