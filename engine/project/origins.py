"""The file that a take came from, kept in its project as the text that it was."""

from __future__ import annotations

import sqlite3

import numpy as np

from engine.formats.livelink import packing
from engine.formats.livelink.origin import Origin
from engine.formats.livelink.packing import Packed
from engine.project.blobs import Budget, DamagedError, pack, unpack, unpack_bytes
from engine.project.tables import insert
from engine.take import Take

PIECE_BYTES = 2**26  # of text in a row of the table: SQLite takes no blob as large as a whole file may be


def write_origin(database: sqlite3.Connection, take: Take) -> None:
    """Put the file that a take came from beside it, as its format packs it; nothing where there is none."""
    packed = packing.pack(take)
    if packed is not None:
        rows, lost = pack(packed.rows), pack(packed.lost)
        insert(database, "origin", (1, len(packed.rows), rows, lost, int(packed.swapped)))
        write_text(database, packed.content)


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
    packed = Packed(_read_text(database, budget), rows.astype(np.int64), lost, bool(swapped))
    try:
        return packing.unpack(packed, take)
    except ValueError as error:
        raise DamagedError("the file it came from is not possible") from error


def _read_text(database: sqlite3.Connection, budget: Budget) -> bytes:
    pieces = []
    for place, (index, count, text) in enumerate(
        database.execute("SELECT place, bytes, text FROM origin_text ORDER BY place")
    ):
        if index != place or not 0 < count <= PIECE_BYTES:
            raise DamagedError("a part of the file it came from is missing")
        pieces.append(unpack_bytes(text, count, budget))
    return b"".join(pieces)
