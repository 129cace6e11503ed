"""What a file holds, whatever its name leads to: a folder, a pipe or a device without an end is refused unread."""

from __future__ import annotations

import stat
from pathlib import Path

from engine.errors import FormatError
from engine.formats.base import inputs

MAX_BYTES = 1 << 30  # a take of seven hours at 60 frames per second


def require_file(path: Path, *, at_most: int = MAX_BYTES) -> None:
    """Raise `FormatError` where a path does not lead to an ordinary file of at most so many bytes."""
    try:
        found = path.stat()
    except (OSError, ValueError) as error:
        raise unread(path, error) from error
    if stat.S_ISDIR(found.st_mode):
        raise FormatError(f"{path.name} is a folder.", "Name a file in it.")
    if not stat.S_ISREG(found.st_mode):
        raise FormatError(f"{path.name} is not an ordinary file.", "Copy what it holds to one.")
    if found.st_size > at_most:
        raise FormatError(f"{path.name} is larger than {at_most >> 20} MB.")
    inputs.note(path)


def content_of(path: Path, *, at_most: int = MAX_BYTES) -> bytes:
    """Return the bytes of an ordinary file; raises `FormatError` where it is none, too large or cannot be read."""
    require_file(path, at_most=at_most)
    try:
        return path.read_bytes()
    except OSError as error:
        raise unread(path, error) from error


def unread(path: Path, error: Exception) -> FormatError:
    """Return the error that tells why a file could not be read."""
    if isinstance(error, FileNotFoundError):
        return FormatError(f"{path.name} could not be read: it is not there.", "It may have been moved or renamed.")
    reason = getattr(error, "strerror", None) or "its name is not possible"
    name = path.name if len(path.name) <= 80 else f"{path.name[:60]}…{path.suffix[:20]}"
    return FormatError(f"{name} could not be read: {reason.lower()}.")
