"""Markers: tracked points over time, from CSV, TRC or C3D."""

from __future__ import annotations

from pathlib import Path

from engine.errors import EditError, FormatError
from engine.formats.markers import c3d, csv, trc
from engine.formats.markers.capture import TO_MM, Markers

ENDINGS = (".csv", ".tsv", ".trc", ".c3d")


def read(path: Path, *, unit: str | None = None, fps: float | None = None) -> Markers:
    """Read a capture from a file of any kind in `ENDINGS`.

    Parameters
    ----------
    path : the file
    unit : mm, cm or m, instead of what the file says or its size suggests
    fps : frame rate, instead of what the file says

    Raises
    ------
    FormatError : with file and, where known, row and column
    """
    if unit is not None and unit not in TO_MM:
        raise FormatError(f"{unit!r} is not a unit of length.", f"Use one of: {', '.join(TO_MM)}.")
    readers = {".csv": csv.read, ".tsv": csv.read, ".trc": trc.read, ".c3d": c3d.read}
    if path.suffix.lower() not in readers:
        raise FormatError(f"{path.name} is not a kind of file that markers can be in.", f"Use: {', '.join(ENDINGS)}.")
    try:
        return readers[path.suffix.lower()](path, unit=unit, fps=fps)
    except EditError as error:
        raise FormatError(f"{path.name} could not be used. {error.sentence}", error.advice) from error


def write(markers: Markers, path: Path) -> None:
    """Write a capture as CSV or TRC, by the file's ending; raises `FormatError` for another."""
    writers = {".csv": csv.write, ".trc": trc.write}
    if path.suffix.lower() not in writers:
        raise FormatError(f"Markers cannot be written to {path.name}.", "Use .csv or .trc.")
    writers[path.suffix.lower()](markers, path)
