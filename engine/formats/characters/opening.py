"""Opening any head that can be shown: our own file, or another program's."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from engine import assets
from engine.character import Character, load
from engine.errors import AssetError
from engine.formats.characters import ict
from engine.formats.characters.reading import Reading, import_head

SECOND = Path("second")  # the name of the second bundled head, in commands and in project files
SECOND_TITLE = "Second head"


def is_second(path: Path) -> bool:
    """Return whether a path is the name of the second bundled head, and no file of that name is there."""
    return path == SECOND and not path.exists()


def title_of(path: Path) -> str:
    """Return what to call the head of a path on screen."""
    return SECOND_TITLE if is_second(path) else path.stem


def is_own(path: Path) -> bool:
    """Return whether a file is a character of ours or a damaged one, and no other program's."""
    return is_second(path) or (path.suffix.lower() == ".npz" and os.path.isfile(path) and not ict.is_ict(path))


def character_of(path: Path, reading: Reading | None = None) -> Character:
    """Return the head in a file of ours or, as corrected, of another program; raises `EngineError` with one sentence.

    The path `second` is the second bundled head.
    """
    if is_second(path):
        return replace(load(assets.SECOND_HEAD), name=SECOND_TITLE)
    if path.suffix.lower() == ".npz":
        try:
            return load(path)
        except AssetError:  # another program's archive is tried next
            if is_own(path):
                raise
    return import_head(path, reading or Reading()).character
