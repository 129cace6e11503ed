"""What older project files kept of a take's file, brought to the way it is kept today."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator

from engine.project.blobs import Budget, DamagedError, unpack, unpack_bytes
from engine.project.origins import write_text
from engine.take import Array, Mask

MAX_DECIMALS, MAX_COLUMNS = 17, 1024


def text_from_values(database: sqlite3.Connection) -> None:
    """Write the file that the second version kept as values, all with as many decimals, as text.

    Reads the table `origin_2` and fills `origin` and `origin_text`; raises `DamagedError` for what cannot be.
    """
    row = database.execute(
        "SELECT header, rows, timecode_bytes, timecodes, frames, recorded, lost, decimals, newline, swapped FROM origin_2"
    ).fetchone()
    if row is None:
        return
    header, count, timecode_bytes, *blobs, decimals, newline, swapped = row
    (pages,), (page_bytes,) = (database.execute(f"PRAGMA {name}").fetchone() for name in ("page_count", "page_size"))
    budget = Budget(pages * page_bytes)
    budget.take(32 * len(header))
    try:
        names = json.loads(header)
    except (ValueError, RecursionError) as error:
        raise DamagedError("a setting cannot be read") from error
    sound = isinstance(names, list) and all(isinstance(name, str) for name in names)
    if not (sound and 2 < len(names) <= MAX_COLUMNS and count >= 1 and timecode_bytes >= 0):
        raise DamagedError("the file it came from is not possible")
    if not (0 <= decimals <= MAX_DECIMALS and newline in (b"\n", b"\r\n")):
        raise DamagedError("the file it came from is not possible")
    timecodes = unpack_bytes(blobs[0], timecode_bytes, budget).split(b"\n")
    values = unpack(blobs[2], (count, len(names) - 2), "<f8", budget)
    lost = unpack(blobs[3], (count,), "u1", budget) != 0
    if len(timecodes) != count:
        raise DamagedError("a timecode is missing")
    head = ",".join(names).encode("utf-8", "replace") + newline
    budget.take(count * len(names) * (decimals + 12))
    text = b"".join([head, *_lines(timecodes, values, lost, decimals, newline)])
    database.execute("INSERT INTO origin VALUES (1, ?, ?, ?, ?)", (count, blobs[1], blobs[3], int(bool(swapped))))
    write_text(database, text)


def _lines(timecodes: list[bytes], values: Array, lost: Mask, decimals: int, newline: bytes) -> Iterator[bytes]:
    count = values.shape[1]
    row_format = ",".join([f"%.{decimals}f"] * count)
    for timecode, row, is_lost in zip(timecodes, values, lost.tolist(), strict=True):
        body = b"0" if is_lost else f"{count},{row_format % tuple(row.tolist())}".encode()
        yield timecode + b"," + body + newline
