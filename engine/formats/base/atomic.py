"""Writing files whole or not at all, and never over what is no plain file or is being read."""

from __future__ import annotations

import os
import secrets
import stat
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from engine.errors import EngineError
from engine.formats.base import inputs
from engine.formats.base.lock import drop_abandoned
from engine.formats.base.owner import owner_mark, owner_runs

PART = ".part"
MAX_STEM_BYTES = 120  # of a file's name that its temporary file bears; file systems take 255 bytes


def write_bytes(path: Path, chunks: Iterable[bytes]) -> None:
    """Write `chunks` to `path` so that a kill at any moment leaves the old file or the new one.

    Raises `EngineError` like `replacement`.
    """
    with replacement(path) as temporary, temporary.open("wb") as file:
        for chunk in chunks:
            file.write(chunk)


@contextmanager
def replacement(path: Path) -> Iterator[Path]:
    """Give a temporary file to write to; when that has gone well it takes the place of `path`, else it is removed.

    It lies in the same folder, since a rename is atomic only within one file system; a link is followed, and what it
    leads to is replaced. Raises `EngineError` when the folder cannot be written or the disk is full, and where the
    place is a device, a folder, write-protected, or an input of the command that runs.
    """
    temporary: str | None = None
    try:
        target = writable(path)
        sweep(target.parent)
        descriptor, temporary = tempfile.mkstemp(prefix=_prefix(target), suffix=PART, dir=target.parent)
        with os.fdopen(descriptor, "r+b") as file:
            yield Path(temporary)
            os.fsync(file.fileno())
        os.chmod(temporary, _mode_of(target))
        os.replace(temporary, target)
        temporary = None
        sync_folder(target.parent)
    except OSError as error:
        raise unwritten(path, error) from error
    finally:
        if temporary is not None and os.path.exists(temporary):
            os.unlink(temporary)


def writable(path: Path) -> Path:
    """Return the file that writing to a path replaces, links followed; raises `EngineError` where it must not be."""
    try:
        target = Path(os.path.realpath(path))
        found = target.stat()
    except (FileNotFoundError, NotADirectoryError):
        return target
    except (OSError, ValueError) as error:
        raise unwritten(path, error) from error
    if stat.S_ISDIR(found.st_mode):
        raise EngineError(f"{path.name} is a folder.", "Name a file in it.")
    if not stat.S_ISREG(found.st_mode):
        raise EngineError(f"{path.name} is not an ordinary file.", "Only those are written over: choose another name.")
    if not found.st_mode & 0o222 or not os.access(target, os.W_OK):
        raise EngineError(f"{path.name} is write-protected.", "Choose another name, or lift the protection.")
    inputs.refuse(path)
    return target


def unwritten(path: Path, error: Exception) -> EngineError:
    """Return the error that tells why a file could not be written."""
    reason = getattr(error, "strerror", None) or "its name is not possible"
    return EngineError(f"{path.name} could not be written: {reason.lower()}.", "Choose another folder, or make room.")


def sweep(folder: Path) -> None:
    """Remove the temporary files and locks of programs that were killed; those of running ones stay."""
    with suppress(OSError), os.scandir(folder) as entries:
        for name in [entry.name for entry in entries if entry.name.startswith(".")]:
            mark = name.removesuffix(PART).rpartition(".")[0].rpartition(".")[2]
            if name.endswith(PART) and owner_runs(mark) is False:
                with suppress(OSError):
                    os.unlink(folder / name)
            drop_abandoned(folder / name)


def sync_folder(folder: Path) -> None:
    """Bring a folder's names to the disk, so that a new file outlives a power cut; not every system can."""
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def _prefix(target: Path) -> str:
    stem = os.fsencode(target.name)[:MAX_STEM_BYTES].decode("utf-8", "ignore")
    return f".{stem}.{owner_mark()}.{secrets.token_hex(2)}"


def _mode_of(path: Path) -> int:
    """Keep the permissions of a file being replaced; otherwise give those of a new file."""
    try:
        return path.stat().st_mode & 0o777
    except OSError:
        umask = os.umask(0)
        os.umask(umask)
        return 0o666 & ~umask
