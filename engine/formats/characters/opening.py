"""Opening any head that can be shown: our own file, or another program's."""

from __future__ import annotations

import os
from pathlib import Path

from engine.character import Character, load
from engine.errors import AssetError
from engine.formats.characters import ict, read
from engine.formats.characters.assemble import assemble


def character_of(path: Path) -> Character:
    """Return the head in a file of ours or of another program; raises `EngineError` with one plain sentence."""
    if path.suffix.lower() == ".npz":
        try:
            return load(path)
        except AssetError:  # another program's archive is tried next
            if os.path.isfile(path) and not ict.is_ict(path):
                raise
    return assemble(read(path)).character
