"""Finds what programs that ended early left: unsaved work, recordings, and projects whose file was replaced."""

from __future__ import annotations

import logging
import os
import time
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import platformdirs

from app.settings import NAME
from engine import project
from engine.errors import EngineError
from engine.formats.base.atomic import sweep
from engine.formats.base.lock import FileLock
from engine.formats.base.unfinished import UNFINISHED
from engine.live.spool import recovered
from engine.project import Contents
from engine.take import timecode
from engine.words import counted

log = logging.getLogger(__name__)


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
        steps = counted(self.edits, "edit")
        return f"{self.name} ({self.length}), {steps}, {self.changed.astimezone():%d %b %Y %H:%M}"


def new_path(folder: Path) -> Path:
    """Return a name for unsaved work that no other has; raises `EngineError` where the folder cannot be made."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = (error.strerror or "unknown reason").lower()
        raise EngineError(
            f"Unsaved work cannot be kept in {folder}: {reason}.", "Save it, so that nothing can be lost."
        ) from error
    return folder / f"{time.strftime('%Y%m%d-%H%M%S')}-{os.getpid()}-{time.monotonic_ns()}{project.ENDING}"


def tidy(folder: Path) -> None:
    """Make unsaved work of what else killed programs left in a folder, and remove what never became anything."""
    sweep(folder)
    project.recover(folder, lambda: new_path(folder))
    for path in folder.glob(UNFINISHED):
        try:
            lock = FileLock(path)
        except (EngineError, OSError) as error:  # it is still made
            log.info("%s is left alone: %s", path.name, error)
            continue
        try:
            take = recovered(path)
            if take is not None:
                project.create(new_path(folder), Contents(take)).close()
            path.unlink()
        except (EngineError, OSError) as error:
            log.info("%s is not offered: %s", path.name, error)
        finally:
            lock.release()


def unsaved_work(folder: Path) -> list[LeftOver]:
    """Return the unsaved work of programs that run no more, newest first."""
    tidy(folder)
    found = []
    for path in folder.glob(f"*{project.ENDING}"):
        try:
            summary = project.peek(path)
        except (EngineError, OSError) as error:  # open elsewhere, or damaged: it is left where it is
            log.info("%s is not offered: %s", path.name, error)
            continue
        length = timecode(summary.frames / summary.fps, summary.fps)
        found.append(LeftOver(path, summary.name, summary.edits, summary.changed, length))
    return sorted(found, key=lambda entry: entry.changed, reverse=True)
