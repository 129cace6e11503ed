"""Writing rows whose blobs are too large to be held twice."""

from __future__ import annotations

import sqlite3
from collections.abc import Sequence


def insert(database: sqlite3.Connection, table: str, row: Sequence[object]) -> None:
    """Add a row with its number first; room is made for what comes in pieces, which is then filled piece by piece."""
    marks = ["zeroblob(?)" if isinstance(value, list) else "?" for value in row]
    values = [sum(map(len, value)) if isinstance(value, list) else value for value in row]
    database.execute(f"INSERT INTO {table} VALUES ({', '.join(marks)})", values)
    columns = [column for column, *_ in database.execute(f"SELECT * FROM {table} LIMIT 0").description]
    for column, value in zip(columns, row, strict=True):
        if isinstance(value, list):
            with database.blobopen(table, column, row[0]) as blob:  # type: ignore[arg-type]
                for piece in value:
                    blob.write(piece)
