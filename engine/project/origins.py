"""The file that a take came from, kept in its project as the text that it was."""

from __future__ import annotations

import sqlite3

import numpy as np

from engine.formats.livelink.columns import columns_of
from engine.formats.livelink.origin import Origin, header_of, row_starts
from engine.project.blobs import Budget, DamagedError, pack, unpack, unpack_bytes
from engine.project.tables import insert
from engine.take import Take

PIECE_BYTES = 2**26  # of text in a row of the table: SQLite takes no blob as large as a whole file may be
MAX_HEADER_BYTES = 64 * 1024


def write_origin(database: sqlite3.Connection, origin: Origin) -> None:
    """Put a file beside its take."""
    insert(database, "origin", (1, len(origin), pack(origin.rows), pack(origin.lost), int(origin.swapped)))
    write_text(database, origin.content)


def write_text(database: sqlite3.Connection, content: bytes) -> None:
    """Put the text of a file in its table, piece by piece."""
    for place, first in enumerate(range(0, len(content), PIECE_BYTES)):
        piece = np.frombuffer(content, "u1")[first : first + PIECE_BYTES]
        insert(database, "origin_text", (place, len(piece), pack(piece)))


def read_origin(database: sqlite3.Connection, take: Take, budget: Budget) -> Origin | None:
    """Return the file that a take came from, None where it came from none; raises `DamagedError` for what cannot be.

    Raises `FormatError` where its text does not begin as a take does.
    """
    row = database.execute("SELECT rows, frames, lost, swapped FROM origin").fetchone()
    if row is None:
        return None
    count, *blobs, swapped = row
    if not 1 <= count <= len(take):
        raise DamagedError("the file it came from is not possible")
    rows = unpack(blobs[0], (count,), "<i8", budget)
    lost = unpack(blobs[1], (count,), "u1", budget) != 0
    if not (np.diff(rows) > 0).all() or rows[0] != 0 or rows[-1] != len(take) - 1:
        raise DamagedError("its rows are out of order")
    content = _read_text(database, budget)
    try:
        starts = row_starts(content, count)
        if lost.all() or starts[0] > MAX_HEADER_BYTES:
            raise ValueError
        columns_of(header_of(content[: starts[0]]), take.name, swapped=bool(swapped))
    except ValueError as error:
        raise DamagedError("the file it came from is not possible") from error
    frames = rows.astype(np.int64)
    return Origin(content, starts, frames, lost, take.weights, take.rotations, bool(swapped))


def _read_text(database: sqlite3.Connection, budget: Budget) -> bytes:
    pieces = []
    for place, (index, count, text) in enumerate(
        database.execute("SELECT place, bytes, text FROM origin_text ORDER BY place")
    ):
        if index != place or not 0 < count <= PIECE_BYTES:
            raise DamagedError("a part of the file it came from is missing")
        pieces.append(unpack_bytes(text, count, budget))
    return b"".join(pieces)
