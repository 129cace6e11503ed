"""Audio and video beside a project: known by their content, looked for where they were and beside the project."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath, PureWindowsPath

from engine.errors import FormatError
from engine.formats.base.content import require_file, unread
from engine.project.open_files import is_open
from engine.project.records import Media

ENDING = ".retake"
MAX_BYTES = 1 << 44  # a film is read in pieces


@dataclass(frozen=True)
class Found:
    """Where a media file is.

    Attributes
    ----------
    path : of the file with the very bytes that were attached; None when there is none
    changed : a file of that name with other bytes, which only the user can accept
    """

    media: Media
    path: Path | None
    changed: Path | None = None

    @property
    def sentence(self) -> str:
        """What the user should hear; empty when all is well."""
        if self.path is not None:
            return ""
        name = name_of(self.media)
        return f"{name} is not the file it was." if self.changed is not None else f"{name} is missing."


def name_of(media: Media) -> str:
    """Return the name of a media file, without its folder."""
    return _name(media.path) or "the file"


def attach(path: Path, folder: Path, *, kind: str, offset_s: float = 0.0) -> Media:
    """Return the record of a media file for a project in a folder; raises `FormatError` when it cannot be read."""
    _require_medium(path)
    try:
        digest = _digest(path)
    except OSError as error:
        raise unread(path, error) from error
    return placed(Media(kind, path.name, digest, offset_s), path, folder)


def placed(media: Media, path: Path, folder: Path) -> Media:
    """Return the record of a media file that is at a path, for a project in a folder."""
    whole, base = path.resolve(), folder.resolve()
    return replace(media, path=whole.relative_to(base).as_posix() if whole.is_relative_to(base) else path.name)


def find(media: Media, folder: Path, elsewhere: Iterable[Path] = ()) -> Found:
    """Look for a media file in its place, then beside the project, then in other folders by its name.

    A path in a project file is never followed out of the project's folder, and only a regular file with the content
    that was attached counts. Reads each candidate once: call it off the GUI thread.
    """
    changed: Path | None = None
    for candidate in _candidates(media, folder, elsewhere):
        try:
            _require_medium(candidate)
            if _digest(candidate) == media.sha256:
                return Found(media, candidate)
        except (OSError, FormatError):
            continue
        changed = changed or candidate
    return Found(media, None, changed)


def _require_medium(path: Path) -> None:
    """Raise `FormatError` for what is no ordinary file, and for the project that is open, under whatever name.

    A program that opens a file a second time and closes it again gives up its locks on it (POSIX), unasked: another
    Retake could then write to the project beside this one.
    """
    require_file(path, at_most=MAX_BYTES)
    if path.suffix.lower() == ENDING or is_open(path):
        raise FormatError(f"{path.name} is a project, and no sound or video.", "Choose a recording or a film.")


def _candidates(media: Media, folder: Path, elsewhere: Iterable[Path]) -> Iterator[Path]:
    place = folder.joinpath(*PurePosixPath(media.path).parts) if _relative(media.path) else None
    name = _name(media.path)
    beside = [base / name for base in (folder, *elsewhere)] if name else []
    for candidate in dict.fromkeys([*([place] if place else []), *beside]):
        try:
            inside = candidate is not place or candidate.resolve().is_relative_to(folder.resolve())
            if inside and candidate.is_file():
                yield candidate
        except (OSError, ValueError):  # a name that no file system takes
            continue


def _relative(path: str) -> bool:
    posix, windows = PurePosixPath(path), PureWindowsPath(path)
    return not (posix.is_absolute() or windows.anchor or ".." in posix.parts or ".." in windows.parts)


def _name(path: str) -> str:
    """Return the last part of a path of either kind."""
    name = PureWindowsPath(path).name
    return "" if name == ".." else name


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
