"""The rows of a Live Link Face CSV, split and read in blocks that no window beside it feels."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from engine.errors import FormatError
from engine.formats.decimals import floats
from engine.take import Array, Mask

BLOCK_BYTES = 1 << 18  # of text read at once: it stays in the cache, and nobody waits for more than one
COMMA, NEWLINE = b",\n"


def table(
    content: bytes, first: int, header: list[str], path: Path, report: Callable[[float], None] | None
) -> tuple[list[bytes], Array, Mask]:
    """Split rows into timecodes and (rows, cells - 2) values; a row of two cells with count 0 is a lost frame."""
    timecodes: list[bytes] = []
    values: list[Array] = []
    lost: list[Mask] = []
    stop = _end(content, first)
    while first < stop:
        end = content.find(b"\n", min(first + BLOCK_BYTES, stop), stop) % (stop + 1)
        block = _block(content[first:end] + b"\n", len(header), len(timecodes) + 2, path, last=end == stop)
        timecodes += block[0]
        values.append(block[1])
        lost.append(block[2])
        if report is not None:
            report(end / stop)
        first = end + 1
    if not timecodes:
        raise FormatError(f"{path.name} has a header but no frames.")
    return timecodes, np.concatenate(values), np.concatenate(lost)


def _end(content: bytes, first: int) -> int:
    """Return where the last row that is not blank ends."""
    stop = len(content)
    while stop > first and content[max(first, stop - BLOCK_BYTES) : stop].isspace():
        stop = max(first, stop - BLOCK_BYTES)
    tail = content[max(first, stop - BLOCK_BYTES) : stop]
    return stop - len(tail) + len(tail.rstrip())


def _block(block: bytes, cells: int, row: int, path: Path, *, last: bool) -> tuple[list[bytes], Array, Mask]:
    """Split whole rows of text, the first of them the row `row` of the file, like `table`."""
    text = np.frombuffer(block, np.uint8)
    ends = np.flatnonzero((text == COMMA) | (text == NEWLINE))
    starts = np.concatenate([[0], ends[:-1] + 1])
    closing = np.flatnonzero(text[ends] == NEWLINE)
    opening = np.concatenate([[0], closing[:-1] + 1])
    counts = closing - opening + 1
    spans = zip(starts[opening].tolist(), ends[opening].tolist(), strict=True)
    timecodes = [block[begin:end].strip() for begin, end in spans]
    lost = counts == 2
    for index in np.flatnonzero(lost | (counts != cells)).tolist():
        lost[index] = lost[index] and block[ends[opening[index]] + 1 : ends[closing[index]]].strip() == b"0"
        if not lost[index] and counts[index] != cells:
            raise FormatError(
                f"{path.name} has {counts[index]} cells in row {row + index} where its header has {cells}.",
                "The file may be cut off or damaged." if last and index == len(counts) - 1 else "",
            )
    numbers = (opening[~lost, None] + np.arange(2, cells)).ravel()
    values = np.zeros((len(counts), cells - 2))
    try:
        values[~lost] = floats(text, starts[numbers], ends[numbers]).reshape(-1, cells - 2)
    except ValueError as error:
        seen, column = divmod(error.args[0], cells - 2)
        cell = numbers[error.args[0]]
        shown = block[starts[cell] : ends[cell]].rstrip(b"\r")[:20].decode("utf-8", "replace")
        raise FormatError(
            f"{path.name} has {shown!r} for a number in row {row + np.flatnonzero(~lost)[seen]}, column {column + 3}."
        ) from None
    return timecodes, values, lost
