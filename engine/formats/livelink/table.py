"""The rows of a Live Link Face CSV, split and read in blocks that no window beside it feels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from engine.errors import FormatError
from engine.formats.base.budget import BUDGET
from engine.formats.base.decimals import floats
from engine.formats.livelink.origin import Places
from engine.take import Array, Mask

BLOCK_BYTES = 1 << 18  # of text read at once: it stays in the cache, and nobody waits for more than one
FEW_VALUES = 20_000_000  # an hour and a half at 60 fps; a longer file has its own bytes to show for them
COMMA, NEWLINE = b",\n"
Rows = tuple[list[bytes], Array, Mask, Places]


def table(
    content: bytes, first: int, columns: tuple[list[str], Places], path: Path, report: Callable[[float], None] | None
) -> Rows:
    """Split rows into timecodes, (rows, cells - 2) values, lost ones, and where each begins and the last one ends.

    `columns` are the names in the header, and the cells that hold numbers; the values of others are 0.
    A row whose count is 0 is a lost frame, however many cells follow: spreadsheets and pandas fill them up.
    """
    header, chosen = columns
    # a lost row of four bytes is as many numbers as the header has columns
    budget = replace(BUDGET, values=max(FEW_VALUES, len(content)))
    timecodes: list[bytes] = []
    values: list[Array] = []
    lost: list[Mask] = []
    starts: list[Places] = []
    stop = _end(content, first)
    while first < stop:
        end = content.find(b"\n", min(first + BLOCK_BYTES, stop), stop) % (stop + 1)
        rows = len(timecodes) + content.count(b"\n", first, end) + 1
        budget.require(path.name, values=rows * len(header))
        block = _block(content[first:end] + b"\n", (len(header), chosen), len(timecodes) + 2, path, last=end == stop)
        timecodes += block[0]
        values.append(block[1])
        lost.append(block[2])
        starts.append(block[3] + first)
        if report is not None:
            report(end / stop)
        first = end + 1
    if not timecodes:
        raise FormatError(f"{path.name} has a header but no frames.")
    ended = content.find(b"\n", stop) + 1 or len(content)
    if not content[stop:ended].isspace():  # only the line ending belongs to the last row
        ended = stop
    return timecodes, np.concatenate(values), np.concatenate(lost), np.concatenate([*starts, [ended]])


def _end(content: bytes, first: int) -> int:
    """Return where the last row that is not blank ends."""
    stop = len(content)
    while stop > first and content[max(first, stop - BLOCK_BYTES) : stop].isspace():
        stop = max(first, stop - BLOCK_BYTES)
    tail = content[max(first, stop - BLOCK_BYTES) : stop]
    return stop - len(tail) + len(tail.rstrip())


def _block(block: bytes, columns: tuple[int, Places], row: int, path: Path, *, last: bool) -> Rows:
    """Split whole rows of text, the first of them the row `row` of the file, like `table`."""
    cells, chosen = columns
    text = np.frombuffer(block, np.uint8)
    ends = np.flatnonzero((text == COMMA) | (text == NEWLINE))
    starts = np.concatenate([[0], ends[:-1] + 1])
    closing = np.flatnonzero(text[ends] == NEWLINE)
    opening = np.concatenate([[0], closing[:-1] + 1])
    counts = closing - opening + 1
    spans = zip(starts[opening].tolist(), ends[opening].tolist(), strict=True)
    timecodes = [block[begin:end].strip() for begin, end in spans]
    lost = _without_face(block, starts[np.minimum(opening + 1, closing)], ends[np.minimum(opening + 1, closing)])
    lost &= counts > 1
    for index in np.flatnonzero(counts != cells).tolist():
        if not lost[index]:
            raise FormatError(
                f"{path.name} has {counts[index]} cells in row {row + index} where its header has {cells}.",
                "The file may be cut off or damaged." if last and index == len(counts) - 1 else "",
            )
    numbers = (opening[~lost, None] + chosen).ravel()
    values = np.zeros((len(counts), cells - 2))
    try:
        values[np.ix_(~lost, chosen - 2)] = floats(text, starts[numbers], ends[numbers]).reshape(-1, len(chosen))
    except ValueError as error:
        seen, column = divmod(error.args[0], len(chosen))
        cell = numbers[error.args[0]]
        shown = block[starts[cell] : ends[cell]].rstrip(b"\r")[:20].decode("utf-8", "replace")
        raise FormatError(
            f"{path.name} has {shown!r} for a number in row {row + np.flatnonzero(~lost)[seen]}, column {chosen[column] + 1}."
        ) from None
    return timecodes, values, lost, starts[opening]


def _without_face(block: bytes, starts: Places, ends: Places) -> Mask:
    """Return which cells of text, (n,) each, hold the number 0."""
    zero: Mask = np.isin(np.frombuffer(block, np.uint8)[starts], np.frombuffer(b'0 "', np.uint8))
    for index in np.flatnonzero(zero).tolist():
        zero[index] = block[starts[index] : ends[index]].strip(b' \t\r"') in (b"0", b"0.0", b"0.", b"00")
    return zero
