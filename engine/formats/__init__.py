"""One module per format family, each with `read` and `write`; this registry picks by file ending."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from engine.errors import FormatError
from engine.formats import livelink
from engine.formats.base.reading import AUTOMATIC, Reading, Sides
from engine.formats.livelink import folder as takes
from engine.take import Take


@dataclass(frozen=True)
class Format:
    """A file format a take can be read from and written to.

    `read` hears the share that is read, and how; `write` whose left and right the columns are to be named by.
    """

    title: str
    endings: tuple[str, ...]
    read: Callable[[Path, Callable[[float], None] | None, Reading], Take]
    write: Callable[[Take, Path, Sides], None]


FORMATS: tuple[Format, ...] = (Format("Live Link Face CSV", (".csv",), livelink.read, livelink.write),)


def format_of(path: Path) -> Format:
    """Return the format that a file's ending names; raises `FormatError` where there is none."""
    for entry in FORMATS:
        if path.suffix.lower() in entry.endings:
            return entry
    known = ", ".join(f"{entry.title} ({'/'.join(entry.endings)})" for entry in FORMATS)
    raise FormatError(f"{path.name} is not a kind of file that a take can be in.", f"Use one of: {known}.")


def read_take(path: Path, report: Callable[[float], None] | None = None, reading: Reading = AUTOMATIC) -> Take:
    """Read a take from any supported file; raises `FormatError` with one plain sentence.

    `report` is told what share of the file is read, 0 to 1; what it raises ends the reading. `reading` is the rate, and
    whose left and right are meant, where that is not to be found out. Of a project, which is saved and not exported, it
    is the take with the edits in effect, read as the project remembers unless something else is asked for.
    """
    if path.suffix.lower() == ".retake":
        from engine.project import Project, replay  # here, since projects themselves keep what formats read

        project = Project.open(path, read_only=True)
        try:
            take = replay(project.contents).take
        finally:
            project.close()
        return livelink.reread(take, reading, keep=True)
    if takes.is_one(path):
        return takes.read(path, report, reading)
    return format_of(path).read(path, report, reading)


def write_take(take: Take, path: Path, sides: Sides = "automatic") -> None:
    """Write a take to any supported file; an existing file is replaced whole or left as it was.

    Left and right of mouth and jaw are written as the file had them that the take came from, or as `sides` says.
    """
    format_of(path).write(take, path, sides)
