"""Second names of open project files, so that replacing or deleting one while it is open loses no step."""

from __future__ import annotations

import logging
import os
import secrets
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from engine.errors import EngineError
from engine.formats.base.owner import owner_mark, owner_runs

log = logging.getLogger(__name__)
ENDING = ".spare"
NOTE = ".of"  # the name of the file that says which project a spare is of


def make(path: Path, folder: Path) -> Path:
    """Give an open project a second name in a folder, or only note there that it is open where links cannot be made."""
    spare = folder / f"{owner_mark()}.{secrets.token_hex(4)}{ENDING}"
    with suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        spare.with_suffix(NOTE).write_text(str(path), "utf-8", "surrogateescape")
        os.link(path, spare)
    return spare


def drop(spare: Path) -> None:
    """Remove a second name."""
    for path in (spare, spare.with_suffix(NOTE)):
        with suppress(OSError):
            path.unlink(missing_ok=True)


def recover(folder: Path, tidy: Callable[[Path, Path], None]) -> None:
    """Let `tidy` have the second name and the path of each project that a program which runs no more had open."""
    for note in folder.glob(f"*{NOTE}"):
        spare = note.with_suffix(ENDING)
        if owner_runs(spare.name.partition(".")[0]) is not False:
            continue
        try:
            tidy(spare, Path(note.read_text("utf-8", "surrogateescape")))
        except (EngineError, OSError) as error:  # in use, or damaged: it is left for another time
            log.info("%s stays: %s", spare.name, error)
        else:
            drop(spare)
