"""Opening any head that can be shown: our own file, or another program's."""

from __future__ import annotations

import os
from pathlib import Path

from engine.character import Character, load
from engine.errors import AssetError
from engine.formats.characters import ict
from engine.formats.characters.reading import Reading, import_head


def is_own(path: Path) -> bool:
    """Return whether a file is a character of ours or a damaged one, and no other program's."""
    return path.suffix.lower() == ".npz" and os.path.isfile(path) and not ict.is_ict(path)


def character_of(path: Path, reading: Reading = Reading()) -> Character:
    """Return the head in a file of ours or, as corrected, of another program; raises `EngineError` with one sentence."""
    if path.suffix.lower() == ".npz":
        try:
            return load(path)
        except AssetError:  # another program's archive is tried next
            if is_own(path):
                raise
    return import_head(path, reading).character
