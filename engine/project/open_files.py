"""The project files that this program has open, known by device and inode, since a file may have several names."""

from __future__ import annotations

import threading
from collections import Counter
from pathlib import Path

File = tuple[int, int]

_open: Counter[File] = Counter()
_lock = threading.Lock()


def register(path: Path) -> File | None:
    """Register a file as open; returns what `release` takes, None where there is no such file."""
    try:
        found = path.stat()
    except OSError:
        return None
    file = found.st_dev, found.st_ino
    with _lock:
        _open[file] += 1
    return file


def release(file: File | None) -> None:
    """Release a file that `register` returned."""
    with _lock:
        if file is not None and _open[file] > 1:
            _open[file] -= 1
        elif file is not None:
            _open.pop(file, None)


def is_open(path: Path) -> bool:
    """Return whether a path leads to a project that this program has open; opens nothing itself."""
    try:
        found = path.stat()
    except (OSError, ValueError):
        return False
    with _lock:
        return (found.st_dev, found.st_ino) in _open
