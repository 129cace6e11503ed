"""Keeping the work safe: each finished step goes to the project file, or to a file of unsaved work until there is one."""

from __future__ import annotations

import logging
import os
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import platformdirs
from PySide6.QtCore import QCoreApplication, QEvent, QObject, Signal

from app.background import LatestWins
from app.session.opening import Opened
from app.session.session import Change, Session
from app.settings import NAME
from engine import project
from engine.errors import EngineError
from engine.formats import read_take
from engine.formats.reading import Reading
from engine.project import Contents, Project
from engine.take import timecode

log = logging.getLogger(__name__)
STALE_S = 86_400.0  # a file that was being made this long ago never will be
RECORDINGS = "*.partial*.csv"
AS_SPOOLED = Reading(sides="recorded")  # it is written as the app does, whatever its motion looks like
ABANDONED_S = 5.0  # a recording is touched every second
PATIENCE_S = 0.3  # a wait that nobody notices when a take is closed


def unsaved_folder() -> Path:
    """Return the folder for unsaved work."""
    return Path(platformdirs.user_data_dir(NAME, appauthor=False)) / "unsaved"


@dataclass(frozen=True)
class LeftOver:
    """Unsaved work that a program which ended early left behind."""

    path: Path
    name: str
    edits: int
    changed: datetime
    length: str

    @property
    def sentence(self) -> str:
        """What to call it in a list."""
        steps = "1 edit" if self.edits == 1 else f"{self.edits} edits"
        return f"{self.name} ({self.length}), {steps}, {self.changed.astimezone():%d %b %Y %H:%M}"


@dataclass(frozen=True, eq=False)
class _Kept:
    """The file that each step goes to, and whether it is the user's own or unsaved work."""

    project: Project
    saved: bool


@dataclass(frozen=True, eq=False)
class _Saving:
    """A wish to save to a path."""

    path: Path


@contextmanager
def _as_unsaved_work(path: Path) -> Iterator[None]:
    """Let an error speak of unsaved work: the name of its file says nothing to the user."""
    try:
        yield
    except EngineError as error:
        raise EngineError(error.sentence.replace(path.name, "unsaved work"), error.advice) from error


class Keeper(QObject):
    """Commits each change of a session's undo stack and marks, and saves projects, on a thread of its own.

    Where a step cannot be written the work stays in memory, and the next step brings all that is missing. While a
    project is being copied, the steps made meanwhile go to the file that is copied, and with it to the copy.

    Parameters
    ----------
    session : what is kept
    folder : for unsaved work; the user's own without one
    """

    failed = Signal(str, str)  # sentence, advice
    mended = Signal(str)  # the sentence of a failure that is over
    kept = Signal(object)  # the Contents that are safe on disk
    saved = Signal(object)  # the path of a project that was just saved
    progress = Signal(float)  # the share of the save that is done, from the keeper's thread
    saving_changed = Signal()

    def __init__(self, session: Session, folder: Path | None = None) -> None:
        super().__init__()
        self._session, self.folder = session, folder or unsaved_folder()
        self._kept: _Kept | None = None
        self._newest = session.contents()  # what is to be written
        self._wished: _Saving | None = None
        self._stopped = False
        self._waits: Contents | None = None  # steps that could not be kept while a copy was made
        self._afterwards: list[Callable[[], None]] = []
        self._opening = False
        self._told = ""
        self._lock = threading.Lock()
        self._work = LatestWins(self._write, name="keeper")
        self._work.done.connect(self._written)
        self._work.failed.connect(self._refused)
        self._work.rested.connect(self._go_on)
        session.undo.indexChanged.connect(self._keep)
        session.changed.connect(self._on_change)

    @property
    def path(self) -> Path | None:
        """The project that every step goes to; None while the work is unsaved."""
        kept = self._kept
        return kept.project.path if kept is not None and kept.saved else None

    @property
    def saving(self) -> Path | None:
        """The path that a project is being saved to."""
        return self._wished.path if self._wished else None

    @property
    def _project(self) -> Project | None:
        return self._kept.project if self._kept is not None else None

    def when_idle(self, then: Callable[[], None]) -> bool:
        """Do something when nothing is being written any more; returns whether nothing is.

        What waits is dropped where a save fails.
        """
        self._afterwards.append(then)
        if not self._work.finish(PATIENCE_S):
            return False
        QCoreApplication.sendPostedEvents(self, QEvent.Type.MetaCall.value)  # what came of it is heard of first
        self._go_on()
        return True

    # --- saving and opening

    def open(self, opened: Opened) -> None:
        """Show a project that was read, undo history included, and let each step go there from now on.

        One that cannot be written is shown all the same, as unsaved work; so is what an earlier start left.
        """
        left_over = opened.wish.left_over
        self._adopt(opened, None if left_over else opened.wish.path, saved=not left_over)
        if left_over:
            self._session.undo.resetClean()

    def release(self) -> None:
        """Let go of the project, so that it can be read anew; what is open is in memory alone until `keep` or `open`."""
        self._detach(delete=False)

    def holds(self, path: Path) -> bool:
        """Whether a path is the project that is open: a file is open once, and what is in memory is in it."""
        return self.path is not None and path.exists() and path.samefile(self.path)

    def save_as(self, path: Path) -> None:
        """Make a project of the session at a path, whole or not at all; from then on each step goes there.

        Returns at once; `saved` or `failed` follows. Where it fails nothing is lost: neither what was at the path, nor
        the work.
        """
        self._newest, self._wished, self._stopped = self._session.contents(), _Saving(path), False
        self._work.submit(self._wished, "save")
        self.saving_changed.emit()

    def stop_saving(self) -> None:
        """Give up the save under way; each step goes on being kept where it was before."""
        self._stopped = True

    def keep(self) -> None:
        """Write what is open even where nothing was edited: a recording exists nowhere else."""
        self._session.undo.resetClean()
        self._submit(self._session.contents())

    def forget(self) -> None:
        """Remove the unsaved work, after it was exported or discarded; a saved project stays as it is."""
        self._detach(delete=True)

    def close(self) -> None:
        """Finish writing and end the thread; unsaved work that was not forgotten is offered at the next start."""
        self._session.undo.indexChanged.disconnect(self._keep)
        self._session.changed.disconnect(self._on_change)
        self._detach(delete=False)
        self._work.stop()

    # --- what an earlier start left

    def left_over(self) -> list[LeftOver]:
        """Return the unsaved work of programs that run no more, newest first."""
        self._sweep()
        self._take_in_recordings()
        found = []
        for path in self.folder.glob(f"*{project.ENDING}"):
            try:
                summary = project.peek(path)
            except (EngineError, OSError) as error:  # open elsewhere, or damaged: it is left where it is
                log.info("%s is not offered: %s", path.name, error)
                continue
            length = timecode(summary.frames / summary.fps, summary.fps)
            found.append(LeftOver(path, summary.name, summary.edits, summary.changed, length))
        return sorted(found, key=lambda entry: entry.changed, reverse=True)

    def discard(self, left: LeftOver) -> None:
        """Remove unsaved work for good; raises `EngineError` when another program has taken it."""
        project.delete(left.path)

    # --- within

    def _keep(self, _: int = 0) -> None:
        stored = self._project and self._project.contents
        if self._opening or (stored and stored.original is not self._session.recorded):
            return  # another take is being opened
        if stored and stored.edits and self._session.undo.count() == 0:
            return  # only opening empties the stack: undoing leaves its steps there
        contents = self._session.contents()
        if stored or contents.edits:
            self._submit(contents)

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE and not self._opening:
            self._detach(delete=False)
        elif change & Change.MARKS and not self._opening:
            contents = self._session.contents()
            if self._project or contents.edits:  # what a take brings with it is no work of the user's
                self._submit(contents)

    def _submit(self, contents: Contents) -> None:
        self._newest = contents
        self._work.submit(contents)

    def _write(self, wanted: Contents | _Saving) -> Project:
        """Bring the file to these contents, or save it elsewhere; runs on the keeper's thread."""
        with self._lock:
            if isinstance(wanted, _Saving):
                return self._save(wanted.path)
            if self._kept is None:
                path = self._new_path()
                with _as_unsaved_work(path):
                    self._kept = _Kept(project.create(path, wanted), saved=False)
            elif wanted is not self._kept.project.contents:  # a save may have brought them already
                with nullcontext() if self._kept.saved else _as_unsaved_work(self._kept.project.path):
                    self._kept.project.put(wanted)
            return self._kept.project

    def _written(self, wanted: Contents | _Saving, result: Project) -> None:
        if self._told:
            self.mended.emit(self._told)
            self._told = ""
        if isinstance(wanted, _Saving):
            self._arrived(wanted, result)
        else:
            self._show_clean(wanted)
            self.kept.emit(wanted)

    def _arrived(self, wanted: _Saving, result: Project) -> None:
        if wanted is self._wished:
            self._end_saving()
        if result is self._project:  # else another take was opened meanwhile
            self._session.path = result.path
            self._show_clean(result.contents)
            self.saved.emit(result.path)

    def _show_clean(self, safe: Contents) -> None:
        now = self._session.contents()
        latest = (now.edits, now.position, now.marks) == (safe.edits, safe.position, safe.marks)
        if self.path and latest and now.original is safe.original:
            self._session.undo.setClean()

    def _refused(self, wanted: Contents | _Saving, sentence: str, advice: str) -> None:
        asked_for = isinstance(wanted, _Saving)
        if asked_for:
            self._afterwards.clear()
        if wanted is self._wished:
            self._end_saving()
        if asked_for or sentence != self._told:  # once is enough, until it works again
            self._told = sentence
            self.failed.emit(sentence, advice)

    def _end_saving(self) -> None:
        self._wished = None
        self.saving_changed.emit()

    def _go_on(self) -> None:
        if self._work.idle:
            waiting, self._afterwards = self._afterwards, []
            for then in waiting:
                then()

    def _adopt(self, opened: Opened, path: Path | None, *, saved: bool) -> None:
        assert opened.project is not None and opened.state is not None
        self._detach(delete=False)
        self._opening = True
        try:
            self._session.restore(opened.project.contents, path, opened.steps, opened.state, opened.measured)
        finally:
            self._opening = False
        if not opened.project.read_only:
            self._kept = _Kept(opened.project, saved)

    def _detach(self, *, delete: bool) -> None:
        """Go on without a file; unsaved work is removed if it is to be deleted, a project of the user's never is."""
        self._work.finish()
        with self._lock:
            before, self._kept = self._kept, None
        if before is not None:
            self._let_go(before.project, delete=delete and not before.saved)
        self._told = ""

    def _let_go(self, old: Project, *, delete: bool) -> None:
        old.close()
        if delete:
            try:
                project.delete(old.path)
            except (EngineError, OSError):
                log.exception("%s was not removed", old.path)

    def _save(self, path: Path) -> Project:
        before, saved = self._kept, self._copy(path)
        self._kept = _Kept(saved, saved=True)
        if before is not None and before.project is not saved:
            self._let_go(before.project, delete=not before.saved)
        return saved

    def _copy(self, path: Path) -> Project:
        contents, old = self._newest, self._project
        if old is not None and contents.original is old.contents.original:
            try:
                old.put(contents)
            except EngineError as error:
                if path.exists() and path.samefile(old.path):
                    raise
                log.warning("all of the work is saved anew: %s", error)
            else:
                return old.save_as(path, self._report_and_keep)
        return project.create(path, contents, self._report)

    def _report(self, share: float) -> None:
        """Tell how far a save is; on the keeper's thread."""
        if self._stopped:
            raise EngineError("The project was not saved.", "Your work is kept as it was before.")
        self.progress.emit(share)

    def _report_and_keep(self, share: float) -> None:
        """Put the steps made meanwhile in the file that is being copied, and so in the copy."""
        self._report(share)
        old, newest = self._project, self._newest
        if old is None or newest in (old.contents, self._waits) or newest.original is not old.contents.original:
            return
        try:
            old.put(newest)
        except EngineError as error:
            self._waits = newest  # once is enough: each attempt lets the copy begin anew
            log.warning("a step waits for the save to end: %s", error)

    def _new_path(self) -> Path:
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            reason = (error.strerror or "unknown reason").lower()
            raise EngineError(
                f"Unsaved work cannot be kept in {self.folder}: {reason}.", "Save it, so that nothing can be lost."
            ) from error
        return self.folder / f"{time.strftime('%Y%m%d-%H%M%S')}-{os.getpid()}-{time.monotonic_ns()}{project.ENDING}"

    def _take_in_recordings(self) -> None:
        """Make unsaved work of live recordings that a program did not come to end; one still being made is left alone."""
        for path in self.folder.glob(RECORDINGS):
            try:
                if time.time() - path.stat().st_mtime > ABANDONED_S:
                    project.create(self._new_path(), Contents(read_take(path, reading=AS_SPOOLED))).close()
                    path.unlink()
            except (EngineError, OSError) as error:
                log.info("%s is not offered: %s", path.name, error)

    def _sweep(self) -> None:
        """Remove what a killed program was making: it never became a project."""
        for path in self.folder.glob(".*.part"):
            try:
                if time.time() - path.stat().st_mtime > STALE_S:
                    path.unlink()
            except OSError:
                continue
