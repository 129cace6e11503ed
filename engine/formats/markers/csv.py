"""Markers as CSV: an optional time or frame column, then x, y and z of each marker; empty cells are gaps."""

from __future__ import annotations

import re
from collections.abc import Iterator
from math import isnan
from pathlib import Path

import numpy as np
import numpy.typing as npt

from engine.errors import FormatError
from engine.formats.base.atomic import write_bytes
from engine.formats.livelink.clock import STANDARD_FPS
from engine.formats.markers.capture import TO_MM, Markers, each_once, unit_by_size
from engine.formats.markers.exports import MOST_HEADINGS, heading_of
from engine.formats.markers.text import decoded, lines_of, numbers
from engine.take import Array

EXPECTED = "A marker CSV has columns such as time, nose_x, nose_y, nose_z; empty cells are gaps."
FALLBACK_FPS = 30.0
SEPARATORS = (",", ";", "\t")
_COORDINATE = re.compile(
    r"^(.+?)(?:[ _.:]+(?:t|trans|translate|translation|pos|position)(?=[ _.]?[xyz]))?"  # what some programs put between
    r"[ _.:]?[(\[]?([xyz])[)\]]?(?: ?[(\[](mm|cm|m|in)[)\]])?$",
    re.IGNORECASE,
)
_TIME = re.compile(
    r"(?:time|timestamp|seconds|secs?|t)(?:[ _]?[(\[]?(s|secs?|seconds|ms|msecs?|milliseconds)[)\]]?)?", re.IGNORECASE
)
SAME_RATE = 5e-4  # share by which a rate may be off a standard one; the next one, of NTSC, is 1e-3 away


def read(path: Path, *, unit: str | None = None, fps: float | None = None) -> Markers:
    """Read a marker CSV; separators may be commas, semicolons or tabs. Parameters and errors as `markers.read`."""
    lines = lines_of(path, EXPECTED)
    first = [decoded(line, path, EXPECTED) for line in lines[:MOST_HEADINGS]]
    parted = next((line for line in first if any(mark in line for mark in SEPARATORS)), "")
    separator = max(SEPARATORS, key=parted.count)
    cells = [[cell.strip().strip('"') for cell in line.split(separator)] for line in first]
    exported = heading_of(cells)
    header = list(exported.cells) if exported else cells[0]
    start = exported.rows if exported else 1
    given, columns, stated = _columns(header, path)
    stated = stated or (exported.unit if exported else None)
    names, doubled = each_once(given)
    if len(lines) <= start:
        raise FormatError(f"{path.name} has a header but no frames.")
    rows = [_plain(line, separator) for line in lines[start:]]
    table = numbers(rows, len(header), separator=separator.encode(), first_row=start + 1, path=path)
    positions = table[:, columns]
    if not np.isfinite(positions).all(axis=2).any():
        raise FormatError(f"{path.name} holds no frame in which a marker was seen.")
    positions[~np.isfinite(positions).all(axis=2)] = np.nan
    notices = [*doubled]
    if unit is None and stated is None:
        stated, notice = unit_by_size(positions[np.isfinite(positions).any(axis=(1, 2))])
        notices.append(notice)
    rate = fps or (exported.fps if exported else None) or _rate(header, table)
    if rate is None:
        rate = FALLBACK_FPS
        notices.append(f"The file has no times: taken as {FALLBACK_FPS:g} fps.")
    return Markers(positions * TO_MM[unit or stated or "mm"], names, rate, path.name, tuple(notices))


def _plain(row: bytes, separator: str) -> bytes:
    """Return a row of numbers without quotes, and with points for the commas of other decimals."""
    bare = row.replace(b'"', b"")
    return bare if separator == "," else bare.replace(b",", b".")


def _columns(header: list[str], path: Path) -> tuple[tuple[str, ...], npt.NDArray[np.int64], str | None]:
    """Return the markers' names, their columns, (n, 3), and the unit that the header names."""
    found: dict[str, list[dict[str, int]]] = {}
    units = set()
    for column, cell in enumerate(header):
        match = _COORDINATE.match(cell)
        if match and not _TIME.fullmatch(cell) and cell.lower() not in ("frame", "index"):
            sets = found.setdefault(match[1], [{}])
            if len(sets[-1]) == 3 and match[2].lower() in sets[-1]:
                sets.append({})  # another marker of the same name
            if match[2].lower() in sets[-1]:
                raise FormatError(f"{path.name} names the column {cell[:40]!r} twice.", EXPECTED)
            sets[-1][match[2].lower()] = column
            units.add(match[3])
    if not found:
        raise FormatError(f"{path.name} has no columns of markers in its first row.", EXPECTED)
    listed = [(name, axes) for name, sets in found.items() for axes in sets]
    placed = sorted(listed, key=lambda marker: min(marker[1].values()))
    for name, axes in placed:
        if len(axes) < 3:
            lacking = next(axis for axis in "xyz" if axis not in axes)
            if len(found[name]) > 1:
                raise FormatError(f"{path.name} names columns of the marker {name[:40]!r} twice.", EXPECTED)
            raise FormatError(f"{path.name} has no {lacking} column for the marker {name[:40]!r}.", EXPECTED)
    if len(units) > 1:
        raise FormatError(f"{path.name} names different units in its first row.", "Use one unit for all markers.")
    columns = np.array([[axes[axis] for axis in "xyz"] for _, axes in placed])
    return tuple(name for name, _ in placed), columns, units.pop()


def _rate(header: list[str], table: Array) -> float | None:
    for column, cell in enumerate(header):
        named = _TIME.fullmatch(cell)
        if named and len(table) > 1:
            steps = np.diff(table[:, column]) / (1000 if (named[1] or "").lower().startswith("m") else 1)
            return _usual_rate(steps[np.isfinite(steps)])
    return None


def _usual_rate(steps: Array) -> float | None:
    """Return frames per second of steps in seconds, (n,), whose times may be rounded; None where they tell none."""
    typical = float(np.median(steps)) if len(steps) else 0.0
    if not 1e-4 < typical < 10:
        return None
    plain = steps[np.abs(steps / typical - 1) < 0.5]  # none is missing between them
    rate = 1 / (float(plain.mean()) if len(plain) else typical)
    nearest = min(STANDARD_FPS, key=lambda standard: abs(standard - rate))
    return nearest if abs(nearest / rate - 1) < SAME_RATE else round(rate, 6)


def write(markers: Markers, path: Path) -> None:
    """Write a capture as CSV with a time column, in mm, gaps empty."""
    write_bytes(path, _encode(markers))


def _encode(markers: Markers) -> Iterator[bytes]:
    cells = [f"{name}_{axis} (mm)" for name in markers.names for axis in "xyz"]
    yield (",".join(["time", *cells]) + "\n").encode()
    for frame, row in enumerate(markers.positions.reshape(len(markers), -1).tolist()):
        values = ",".join("" if isnan(value) else f"{value:.6f}" for value in row)
        yield f"{frame / markers.fps:.9f},{values}\n".encode()
