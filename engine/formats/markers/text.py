"""Tables of numbers with gaps, as marker files hold them."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np

from engine.errors import FormatError
from engine.formats.base.content import content_of
from engine.formats.markers.capture import CAPTURE_BUDGET
from engine.take import Array

MAX_CELLS = 3 * 4096
MORE_LINES = 100  # of a file than it has frames
BLOCK = 1_000_000  # cells that are parsed at a time
MAX_HEADER_BYTES = 512 * 1024


def lines_of(path: Path, expected: str) -> list[bytes]:
    """Return a text file's lines without their ends; raises `FormatError` where it is empty, unreadable or no text."""
    content = content_of(path)
    CAPTURE_BUDGET.require(path.name, frames=max(0, content.count(b"\n") - MORE_LINES))
    if not content.strip():
        raise FormatError(f"{path.name} is empty.", expected)
    if b"\x00" in content[:MAX_HEADER_BYTES]:
        raise FormatError(f"{path.name} is not a text file.", expected)
    return [line.rstrip(b"\r") for line in content.removeprefix(b"\xef\xbb\xbf").rstrip().split(b"\n")]


def decoded(line: bytes, path: Path, expected: str) -> str:
    """Return a header line, UTF-8 or Windows' Latin letters, as text; raises `FormatError` where it is too long or none."""
    if len(line) > MAX_HEADER_BYTES or max(line.count(mark) for mark in (b",", b"\t", b";")) > MAX_CELLS:
        raise FormatError(f"{path.name} has too many columns.", expected)
    try:
        return line.decode("utf-8")
    except UnicodeDecodeError:
        pass
    try:
        return line.decode("cp1252")
    except UnicodeDecodeError:
        raise FormatError(f"{path.name} is not a text file.", expected) from None


def numbers(lines: list[bytes], cells: int, *, separator: bytes, first_row: int, path: Path) -> Array:
    """Return (rows, cells) float64, NaN where a cell is empty; short rows are gaps to their end.

    Raises `FormatError` with row and column of what is no finite number, and for a row with too many cells.
    """
    CAPTURE_BUDGET.require(path.name, values=len(lines) * cells)  # a short row declares as many as a full one
    table = np.empty((len(lines), cells))
    step = max(1, BLOCK // cells)
    for start in range(0, len(lines), step):
        part = lines[start : start + step]
        table[start : start + step] = _block(part, cells, separator=separator, first_row=first_row + start, path=path)
    infinite = np.argwhere(np.isinf(table))
    if len(infinite):
        row, column = infinite[0]
        raise FormatError(f"{path.name} has an infinite number in row {row + first_row}, column {column + 1}.")
    return np.asarray(table)


def _block(lines: list[bytes], cells: int, *, separator: bytes, first_row: int, path: Path) -> Array:
    """Return some rows of `numbers`: as text all of them would take several times the memory."""
    rows = []
    for row, line in enumerate(lines, first_row):
        parts = line.split(separator)
        while len(parts) > cells and not parts[-1].strip():
            parts.pop()
        if len(parts) > cells:
            raise FormatError(f"{path.name} has {len(parts)} cells in row {row} where its header has {cells}.")
        parts += [b""] * (cells - len(parts))
        rows.append(b",".join(part if part.strip() else b"nan" for part in parts))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            return np.fromstring(b",".join(rows), dtype=np.float64, sep=",").reshape(len(rows), cells)
        except (ValueError, DeprecationWarning):
            raise _blame(rows, first_row, path) from None


def _blame(rows: list[bytes], first_row: int, path: Path) -> FormatError:
    for row, line in enumerate(rows, first_row):
        for column, cell in enumerate(line.split(b","), 1):
            try:
                float(cell)
            except ValueError:
                shown = cell[:20].decode("utf-8", "replace")
                return FormatError(f"{path.name} has {shown!r} for a number in row {row}, column {column}.")
    return FormatError(f"{path.name} could not be read as numbers.")
