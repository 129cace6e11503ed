"""Project files on disk: made whole or not at all, brought up to date by one transaction for each finished step."""

from __future__ import annotations

import os
import sqlite3
import stat
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path

from engine.errors import EngineError, FormatError
from engine.formats.base.atomic import replacement, sweep, unwritten
from engine.formats.base.content import require_file
from engine.project import open_files, rows, schema, spares
from engine.project.blobs import Budget
from engine.project.claim import JOURNALS, Claim, belongs, head_of, is_hot
from engine.project.database import BESIDE, connect, copied, keep_safe, scrap, sentences, settle
from engine.project.mark_rows import write_marks
from engine.project.records import Contents, Summary

ENDING = ".retake"
MAX_FILE_BYTES = 2**36
STEP_PAGES = 512  # that are copied at a time, 2 MiB

Report = Callable[[float], None]  # the share that is done, 0 to 1; an `EngineError` raised by it stops the work


class Project:
    """An open project file, locked against other programs for as long as it is open.

    Each step is flushed to the file itself: a kill loses nothing that `put` has returned from, neither does a power
    cut, and a copy of the file alone holds every step. A file that another one took the place of is never written.
    """

    def __init__(self, path: Path, contents: Contents, own: tuple[sqlite3.Connection, Claim] | None = None) -> None:
        self.path = path
        self._contents = contents
        self._database = own[0] if own else None
        self._claim = own[1] if own else None
        self._spare: Path | None = None
        self._held = open_files.register(path) if self._database is not None else None

    @classmethod
    def open(cls, path: Path, *, read_only: bool = False) -> Project:
        """Open a project; one that cannot be written, or shall not be, is read without a trace and refuses `put`.

        Reading works beside another program that has the project open, and gives what is safe there. Raises
        `FormatError` for a file that is damaged or no project, and, unless it is only read, `InUseError` for one that
        is open elsewhere.
        """
        require_file(path, at_most=MAX_FILE_BYTES)
        claim = None if read_only else _claim_of(path)
        if claim is None:
            with copied(path) as copy:
                return cls(path, _read_alone(copy))
        with _released_on_error(claim):
            database = connect(claim.path, path.name)
            try:
                contents = _read(database, claim.path)
                keep_safe(database, path.name)
                claim.note()
            except BaseException:
                database.close()
                raise
        return cls(path, contents, (database, claim))

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

        What is the same object as before is not written again. Raises `EngineError` where it cannot be written,
        `DisplacedError` where the file is no more the one that was opened; it then is as it was, and the next `put`
        writes all that is missing.
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
                write_marks(database, contents.marks)
            rows.write_state(database, contents)
        self._contents = contents

    def check(self) -> None:
        """Raise `DisplacedError` where the file is no more the one that was opened; one that is only read may be."""
        if self._claim is not None:
            self._claim.check(self.path.name)

    def keep_spare(self, folder: Path) -> None:
        """Give the file a second name in a folder, by which `recover` finds it if somebody replaces or deletes it."""
        if self._claim is not None and self._spare is None:
            self._spare = spares.make(self._claim.path, folder)

    def save_as(self, path: Path, report: Report = lambda _: None) -> Project:
        """Copy the file to a path and open the copy; what was at the path stays there, whole, until the copy is.

        `report` may `put` further contents: SQLite brings them to the part that is copied already, until all is.
        """
        database, _ = self._writable()
        if path.exists() and path.samefile(self.path):
            return self
        with _replaced(path) as (claim, temporary), closing(scrap(temporary)) as copy:
            contents = self._contents

            def step(_: int, left: int, pages: int) -> None:
                nonlocal contents
                contents = self._contents  # what is put after the last step is in the old file alone
                report(1 - left / max(1, pages))

            database.backup(copy, pages=STEP_PAGES, progress=step)
        return _attach(path, contents, claim)

    def __del__(self) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the file."""
        if self._database is None or self._claim is None:
            return
        self._database.close()  # without a step under way it writes nothing, and SQLite leaves what it finds replaced
        self._claim.release()
        self._database = self._claim = None
        if self._spare is not None:
            spares.drop(self._spare)
        open_files.release(self._held)

    def _writable(self) -> tuple[sqlite3.Connection, Claim]:
        if self._database is None or self._claim is None:
            raise EngineError(f"{self.path.name} cannot be written.", "Save it under another name.")
        self._claim.check(self.path.name)
        return self._database, self._claim

    @contextmanager
    def _transaction(self) -> Iterator[sqlite3.Connection]:
        database, claim = self._writable()
        try:
            with sentences(self.path.name):
                database.execute("BEGIN IMMEDIATE")
                try:
                    yield database
                    database.execute("COMMIT")
                except BaseException:
                    if database.in_transaction:
                        database.execute("ROLLBACK")
                    raise
        finally:
            claim.note()  # what was undone has touched the file too


def create(path: Path, contents: Contents, report: Report = lambda _: None) -> Project:
    """Make a project file and open it; a file that is there already is replaced whole or left as it was."""
    with _replaced(path) as (claim, temporary), closing(scrap(temporary)) as database:
        database.execute("BEGIN")
        schema.build(database)
        rows.write_contents(database, contents, report)
        database.execute("COMMIT")
        report(1.0)
    return _attach(path, contents, claim)


def peek(path: Path) -> Summary:
    """Return what a project is, and bring no older version up to date; raises as `Project.open` does."""
    claim = _claim_of(path)
    try:
        if claim is not None:
            claim.shed_foreign_journal(_whole, _rolled_back)
            with closing(connect(claim.path, path.name)) as database, sentences(path.name):
                if schema.check(database, path.name) == schema.VERSION:
                    return rows.read_summary(database)
        with copied(path) as copy, closing(connect(copy, path.name)) as database, sentences(path.name):
            schema.migrate(database, schema.check(database, path.name))
            return rows.read_summary(database)
    finally:
        if claim is not None:
            claim.release()


def delete(path: Path) -> None:
    """Remove a project and what lies beside it; raises `InUseError` when it is open elsewhere."""
    claim = Claim(path)
    try:
        with suppress(FormatError):
            settle(claim.path, path.name)
        path.unlink(missing_ok=True)
        _clear_beside(claim.path)
    finally:
        claim.release()


def recover(folder: Path, new_path: Callable[[], Path]) -> None:
    """Put in order what killed programs had open, by the second names that they had given it in a folder.

    A project that was replaced or deleted while it was open goes to a new path in that folder, with all its steps.
    """

    def tidy(spare: Path, path: Path) -> None:
        sweep(path.parent)
        claim = _claim_of(path) if path.parent.is_dir() else None
        try:
            displaced = spare.exists() and not (path.exists() and path.samefile(spare))
            if displaced:
                for ending in JOURNALS:
                    journal = path.with_name(path.name + ending)
                    if claim and is_hot(journal) and belongs(journal, spare, claim.record, _whole, _rolled_back):
                        os.replace(journal, spare.with_name(spare.name + ending))
                settle(spare, path.name)
                os.replace(spare, new_path())
            if claim is not None:
                claim.shed_foreign_journal(_whole, _rolled_back)
                if path.exists():
                    settle(path, path.name)
        finally:
            if claim is not None:
                claim.release()

    spares.recover(folder, tidy)


def _claim_of(path: Path) -> Claim | None:
    """Take the right to write a project; returns None where it, or its folder, cannot be written."""
    protected = path.exists() and not stat.S_IMODE(path.stat().st_mode) & 0o222
    if protected or not (os.access(path.parent, os.W_OK) and (os.access(path, os.W_OK) or not path.exists())):
        return None
    try:
        return Claim(path)
    except OSError:
        return None


@contextmanager
def _released_on_error(claim: Claim) -> Iterator[None]:
    """Shed what a killed program left beside the file and open its descriptor; let go of it where that goes wrong."""
    try:
        claim.shed_foreign_journal(_whole, _rolled_back)
        claim.begin()
        yield
    except BaseException:
        claim.release()
        raise


@contextmanager
def _replaced(path: Path) -> Iterator[tuple[Claim, Path]]:
    """Give a temporary file that takes the place of a project, and the right to write it, which the caller keeps."""
    try:
        claim = Claim(path)
    except OSError as error:
        raise unwritten(path, error) from error
    try:
        _settle(claim, path)
        with sentences(path.name), replacement(claim.path) as temporary:
            yield claim, temporary
    except BaseException:
        claim.release()
        raise


def _settle(claim: Claim, path: Path) -> None:
    """Bring a project that is about to be replaced into its one file, since its log must not meet the new one."""
    if claim.path.is_file():
        claim.shed_foreign_journal(_whole, _rolled_back)
        try:
            settle(claim.path, path.name)
        except FormatError:
            if claim.path.with_name(f"{claim.path.name}-wal").exists():
                raise  # a damaged project with its last steps beside it: whatever can be saved of it is kept
            return
    _clear_beside(claim.path)


def _attach(path: Path, contents: Contents, claim: Claim) -> Project:
    """Open a file that has just been written, without reading it again."""
    with _released_on_error(claim):
        database = connect(claim.path, path.name)
        keep_safe(database, path.name)
        claim.note()
    return Project(path, contents, (database, claim))


def _read(database: sqlite3.Connection, path: Path) -> Contents:
    with sentences(path.name):
        schema.migrate(database, schema.check(database, path.name))
        log = path.with_name(f"{path.name}-wal")
        stored = path.stat().st_size + (log.stat().st_size if log.exists() else 0)
        return rows.read_contents(database, Budget(stored))


def _read_alone(copy: Path) -> Contents:
    with closing(connect(copy, copy.name)) as database:
        return _read(database, copy)


def _whole(path: Path) -> bool:
    """Return whether a project can be read without what lies beside it."""
    try:
        with copied(path, logs=False) as copy:
            _read_alone(copy)
    except EngineError:
        return False
    return True


def _rolled_back(path: Path, journal: Path) -> str:
    """Return the head of a project as its journal would restore it; nothing where it cannot."""
    try:
        with copied(path, logs=False) as copy:
            copy.with_name(copy.name + journal.name[journal.name.rindex("-") :]).write_bytes(journal.read_bytes())
            settle(copy, path.name)
            with copy.open("rb") as file:
                return head_of(file.fileno())
    except (EngineError, OSError):
        return ""


def _clear_beside(path: Path) -> None:
    try:
        for ending in BESIDE:
            path.with_name(path.name + ending).unlink(missing_ok=True)
    except NotADirectoryError:
        return
    except OSError as error:
        raise unwritten(path, error) from error
