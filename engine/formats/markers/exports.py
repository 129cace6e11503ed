"""Marker tables with several lines of headings, as Vicon, Motive and Qualisys export them, as one plain heading."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from engine.formats.markers.capture import unit_named

MOST_HEADINGS = 40  # lines before the first frame
AXES = ("x", "y", "z")
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


@dataclass(frozen=True)
class Heading:
    """What stands above the numbers of a table.

    Attributes
    ----------
    cells : what each column is, such as Chin_x; empty where it is no marker's and no time
    rows : lines that it takes
    unit, fps : what it says of them, where it does
    """

    cells: tuple[str, ...]
    rows: int
    unit: str | None
    fps: float | None


def heading_of(lines: Sequence[Sequence[str]]) -> Heading | None:
    """Return the heading of a table whose first lines have these cells; None where it is none of several lines."""
    first = [line[0].strip().lower() for line in lines if line]
    if "no_of_markers" in first and "marker_names" in first:
        return _qualisys(lines)
    for row, line in enumerate(lines):
        places = [place for place, cell in enumerate(line) if cell.strip().lower() == "x"]
        places = [at for at in places if [cell.strip().lower() for cell in line[at : at + 3]] == list(AXES)]
        if places and row:
            return _under(lines, row, places)
    return None


def _under(lines: Sequence[Sequence[str]], row: int, places: Sequence[int]) -> Heading | None:
    """Return the heading whose line of axes is `row`, with X of each marker in `places`."""
    above = {_label(line): line for line in lines[:row]}
    named = above.get("name") or next((line for line in reversed(lines[:row]) if any(line[1:])), None)
    if named is None:
        return None
    cells = [cell.strip() if cell.strip().lower().startswith("time") else "" for cell in lines[row]]
    kinds, moves = above.get("type"), lines[row - 1] if "name" in above else None
    for place in places:
        marker = kinds is None or "marker" in _at(kinds, place).lower()
        if marker and (moves is None or _at(moves, place).lower() == "position") and _at(named, place):
            for axis, name in enumerate(AXES):
                cells[place + axis] = f"{_at(named, place)}_{name}"
    says = {key.lower(): value for line in lines[:row] for key, value in pairwise(line) if key}
    below = lines[row + 1] if row + 1 < len(lines) else []
    unit = unit_named(says.get("length units", "") or _at(below, places[0]))
    rate = (
        says.get("export frame rate") or says.get("capture frame rate") or (lines[1][0] if row > 1 and lines[1] else "")
    )
    return Heading(tuple(cells), row + 1 + bool(unit_named(_at(below, places[0]))), unit, _number(rate))


def _qualisys(lines: Sequence[Sequence[str]]) -> Heading:
    """Return the heading of a TSV file of Qualisys, with or without a line of columns."""
    fields = {line[0].strip().lower(): line[1:] for line in lines if line}
    names = [name.strip() for name in fields["marker_names"] if name.strip()]
    last = max(row for row, line in enumerate(lines) if line and re.match("[A-Za-z]", line[0].strip()))
    timed = lines[last][0].strip().lower() == "frame"
    coordinates = [f"{name}_{axis}" for name in names for axis in AXES]
    rate = fields.get("frequency") or [""]
    return Heading((*(("", "Time") if timed else ()), *coordinates), last + 1, "mm", _number(rate[0]))


def _label(line: Sequence[str]) -> str:
    return next((cell.strip().lower() for cell in line[:2] if cell.strip()), "")


def _at(line: Sequence[str], place: int) -> str:
    return line[place].strip() if place < len(line) else ""


def _number(text: str) -> float | None:
    return float(text) if _NUMBER.fullmatch(text.strip()) else None
