"""Writing files whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from engine.errors import EngineError


def write_bytes(path: Path, chunks: Iterable[bytes]) -> None:
    """Write `chunks` to `path` so that a kill at any moment leaves the old file or the new one.

    Raises `EngineError` when the folder cannot be written or the disk is full.
    """
    with replacement(path) as temporary, temporary.open("wb") as file:
        for chunk in chunks:
            file.write(chunk)


@contextmanager
def replacement(path: Path) -> Iterator[Path]:
    """Give a temporary file to write to; when that has gone well it takes the place of `path`, else it is removed.

    It lies in the same folder, since a rename is atomic only within one file system. Raises `EngineError` when the
    folder cannot be written or the disk is full.
    """
    temporary: str | None = None
    try:
        descriptor, temporary = tempfile.mkstemp(prefix=f".{path.name[:80]}.", suffix=".part", dir=path.parent)
        with os.fdopen(descriptor, "r+b") as file:
            yield Path(temporary)
            os.fsync(file.fileno())
        os.chmod(temporary, _mode_of(path))
        os.replace(temporary, path)
        temporary = None
    except OSError as error:
        reason = error.strerror or str(error)
        raise EngineError(
            f"{path.name} could not be written: {reason.lower()}.", "Choose another folder, or make room."
        ) from error
    finally:
        if temporary is not None and os.path.exists(temporary):
            os.unlink(temporary)


def _mode_of(path: Path) -> int:
    """Keep the permissions of a file being replaced; otherwise give those of a new file."""
    try:
        return path.stat().st_mode & 0o777
    except OSError:
        umask = os.umask(0)
        os.umask(umask)
        return 0o666 & ~umask
