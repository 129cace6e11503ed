"""Landmark files: which vertex of a character carries which marker, as CSV with the columns marker and vertex."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from engine.character import Character
from engine.errors import FormatError
from engine.formats.base.atomic import write_bytes
from engine.formats.markers.text import decoded, lines_of

EXPECTED = "A landmark file has the columns marker,vertex and one row for each marker."


def read(path: Path, *, head: Character) -> dict[str, int]:
    """Return a head's vertex by marker name; the file has the numbers of the file that the head came from.

    Raises `FormatError` with the row of what is no vertex or twice there.
    """
    vertices = len(head.split) or len(head.neutral)
    lines = [decoded(line, path, EXPECTED) for line in lines_of(path, EXPECTED)]
    if [cell.strip().lower() for cell in lines[0].split(",")] != ["marker", "vertex"]:
        raise FormatError(f"{path.name} does not begin with the row marker,vertex.", EXPECTED)
    found: dict[str, int] = {}
    for row, line in enumerate(lines[1:], 2):
        if not line.strip():
            continue
        name, _, vertex = (part.strip() for part in line.rpartition(","))
        if not (vertex.isascii() and vertex.isdigit() and len(vertex) < 10 and int(vertex) < vertices):
            raise FormatError(f"{path.name} has {vertex[:20]!r} for a vertex in row {row}.", f"There are {vertices}.")
        if name in found or not name:
            raise FormatError(f"{path.name} names the marker {name[:40]!r} twice or not at all in row {row}.")
        found[name] = head.vertex_of(int(vertex))
    if not found:
        raise FormatError(f"{path.name} names no marker.", EXPECTED)
    return found


def write(places: Mapping[str, int], path: Path, *, head: Character) -> None:
    """Write a head's vertices by marker name for `read`; raises `EngineError` when the folder cannot be written."""
    rows = ["marker,vertex", *(f"{name},{head.number_of(vertex)}" for name, vertex in places.items()), ""]
    write_bytes(path, ["\n".join(rows).encode()])
