"""What a command reads, so that nothing it writes takes the place of it unasked."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

from engine.errors import EngineError

Files = set[tuple[int, int]]  # device and inode

_read: ContextVar[Files | None] = ContextVar("read", default=None)


@contextmanager
def protected(*, allowed: bool = False) -> Iterator[None]:
    """Remember each file that is read within, and refuse to write over it unless that is allowed."""
    before = _read.set(None if allowed else set())
    try:
        yield
    finally:
        _read.reset(before)


def note(path: Path) -> None:
    """Remember a file, or a folder, that is read."""
    noted = _read.get()
    if noted is not None and (file := _file(path)) is not None:
        noted.add(file)


def refuse(path: Path) -> None:
    """Raise `EngineError` where a path leads to a file that was read."""
    noted = _read.get()
    if noted and _file(path) in noted:
        raise EngineError(
            f"{path.name} is what this command reads.", "Name another file, or add --overwrite to replace it."
        )


def _file(path: Path) -> tuple[int, int] | None:
    try:
        found = os.stat(path)
    except (OSError, ValueError):
        return None
    return found.st_dev, found.st_ino
