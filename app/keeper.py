"""Keeping the work safe: each finished step goes to the project file, or to a file of unsaved work until there is one."""

from __future__ import annotations

import logging
import os
import threading
import time
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import platformdirs
from PySide6.QtCore import QObject, Signal

from app.background import LatestWins
from app.commands import restored
from app.session import Change, Session
from app.settings import NAME
from engine import project
from engine.errors import EngineError
from engine.formats import read_take
from engine.project import Contents, Project
from engine.take import timecode

log = logging.getLogger(__name__)
STALE_S = 86_400.0  # a file that was being made this long ago never will be
RECORDINGS = "*.partial*.csv"
ABANDONED_S = 5.0  # a recording is touched every second


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


class Keeper(QObject):
    """Commits each change of a session's undo stack and marks, on a thread of its own.

    Where a step cannot be written the work stays in memory, and the next step brings all that is missing.

    Parameters
    ----------
    session : what is kept
    folder : for unsaved work; the user's own without one
    """

    failed = Signal(str, str)  # sentence, advice
    kept = Signal(object)  # the Contents that are safe on disk

    def __init__(self, session: Session, folder: Path | None = None) -> None:
        super().__init__()
        self._session, self.folder = session, folder or unsaved_folder()
        self._project: Project | None = None
        self._saved = False  # whether the project is a file of the user's, and not unsaved work
        self._opening = False
        self._told = ""
        self._lock = threading.Lock()
        self._work = LatestWins(self._write, name="keeper")
        self._work.done.connect(self._written)
        self._work.failed.connect(self._refused)
        session.undo.indexChanged.connect(self._keep)
        session.changed.connect(self._on_change)

    @property
    def path(self) -> Path | None:
        """The project that every step goes to; None while the work is unsaved."""
        return self._project.path if self._project is not None and self._saved else None

    # --- saving and opening

    def open(self, path: Path) -> None:
        """Open a project in the session, undo history included; what is open stays where it cannot be read.

        Raises `EngineError`. One that cannot be written is opened all the same, as unsaved work.
        """
        self._adopt(Project.open(path), path, saved=True)

    def save_as(self, path: Path) -> None:
        """Make a project of the session at a path, whole or not at all; from then on each step goes there.

        Raises `EngineError`, and then nothing is lost: neither what was at the path, nor the work.
        """
        contents = self._session.contents()
        self._work.finish()
        with self._lock:
            before = self._project
            saved = self._copy(contents, path)
            self._project = saved
        if before is not None and before is not saved:
            self._let_go(before, delete=not self._saved)
        self._saved, self._told = True, ""
        self._session.path = path
        self._session.undo.setClean()

    def keep(self) -> None:
        """Write what is open even where nothing was edited: a recording exists nowhere else."""
        self._session.undo.resetClean()
        self._work.submit(self._session.contents())

    def forget(self) -> None:
        """Remove the unsaved work, after it was exported or discarded; a saved project stays as it is."""
        self._detach(delete=not self._saved)

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

    def recover(self, left: LeftOver) -> None:
        """Open unsaved work in the session, where it goes on being unsaved; raises `EngineError`."""
        self._adopt(Project.open(left.path), None, saved=False)
        self._session.undo.resetClean()

    def discard(self, left: LeftOver) -> None:
        """Remove unsaved work for good; raises `EngineError` when another program has taken it."""
        project.delete(left.path)

    # --- within

    def _keep(self, _: int = 0) -> None:
        stored = self._project and self._project.contents
        if self._opening or (stored and stored.original is not self._session.original):
            return  # another take is being opened
        if stored and stored.edits and self._session.undo.count() == 0:
            return  # only opening empties the stack: undoing leaves its steps there
        contents = self._session.contents()
        if stored or contents.edits:
            self._work.submit(contents)

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE and not self._opening:
            self._detach(delete=False)
        elif change & Change.MARKS and not self._opening:
            self._work.submit(self._session.contents())

    def _write(self, contents: Contents) -> None:
        """Bring the file to these contents; runs on the keeper's thread."""
        with self._lock:
            if self._project is None:
                self._project = project.create(self._new_path(), contents)
            else:
                self._project.put(contents)

    def _written(self, contents: Contents, _: object) -> None:
        self._told = ""
        now = self._session.contents()
        latest = (now.edits, now.position, now.marks) == (contents.edits, contents.position, contents.marks)
        if self._saved and latest and now.original is contents.original:
            self._session.undo.setClean()
        self.kept.emit(contents)

    def _refused(self, _: object, sentence: str, advice: str) -> None:
        if sentence != self._told:  # once is enough, until it works again
            self._told = sentence
            self.failed.emit(sentence, advice)

    def _adopt(self, opened: Project, path: Path | None, *, saved: bool) -> None:
        self._detach(delete=False)
        contents = opened.contents
        state = project.replay(contents)
        self._opening = True
        try:
            self._session.restore(contents, path, restored(self._session, contents, state), state)
        finally:
            self._opening = False
        if not opened.read_only:
            self._project, self._saved = opened, saved

    def _detach(self, *, delete: bool) -> None:
        self._work.finish()
        with self._lock:
            before, self._project = self._project, None
        if before is not None:
            self._let_go(before, delete=delete)
        self._saved, self._told = False, ""

    def _let_go(self, old: Project, *, delete: bool) -> None:
        old.close()
        if delete:
            try:
                project.delete(old.path)
            except (EngineError, OSError):
                log.exception("%s was not removed", old.path)

    def _copy(self, contents: Contents, path: Path) -> Project:
        if self._project is not None and contents.original is self._project.contents.original:
            try:
                self._project.put(contents)
            except EngineError as error:
                if path.exists() and path.samefile(self._project.path):
                    raise
                log.warning("all of the work is saved anew: %s", error)
            else:
                return self._project.save_as(path)
        return project.create(path, contents)

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
                    project.create(self._new_path(), Contents(read_take(path))).close()
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
