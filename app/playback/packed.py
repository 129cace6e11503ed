"""Films that came in a zip: copied to the user's cache, where they play from, and removed when long unused."""

from __future__ import annotations

import contextlib
import os
import time
from pathlib import Path

import platformdirs

from app.settings import NAME
from engine.formats.livelink.folder import copy_film

UNUSED_S = 30 * 86_400.0  # after which a copy goes


def films_folder() -> Path:
    """Return the folder for films that came in a zip."""
    return Path(platformdirs.user_cache_dir(NAME, appauthor=False)) / "films"


def unpacked(path: Path) -> Path | None:
    """Return the film of a zip as a file of its own, None where it holds none; raises `EngineError`."""
    folder = films_folder()
    _sweep(folder)
    film = copy_film(path, folder)
    if film is not None:
        with contextlib.suppress(OSError):
            os.utime(film)  # it is in use
    return film


def _sweep(folder: Path) -> None:
    with contextlib.suppress(OSError):
        for film in folder.iterdir():
            if time.time() - film.stat().st_mtime > UNUSED_S:
                film.unlink()
