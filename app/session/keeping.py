"""What the keeper's thread is asked for, and the file that it keeps the work in."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from engine.errors import EngineError
from engine.project import Project


@dataclass(frozen=True, eq=False)
class Kept:
    """The file that each step goes to, and whether it is the user's own or unsaved work."""

    project: Project
    saved: bool


@dataclass(frozen=True, eq=False)
class Saving:
    """A wish to save to a path."""

    path: Path


@dataclass(frozen=True, eq=False)
class Look:
    """A wish to see whether the project is still the one that was opened."""


@contextmanager
def as_unsaved_work(path: Path) -> Iterator[None]:
    """Let an error speak of unsaved work: the name of its file says nothing to the user."""
    try:
        yield
    except EngineError as error:
        raise EngineError(error.sentence.replace(path.name, "unsaved work"), error.advice) from error
