"""Rows of a project file: blobs too large to be in memory twice, checked JSON, required rows."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Sequence
from typing import Any

from engine.project.blobs import Budget, DamagedError

JSON_BYTES = 32  # that a character of JSON may grow to when it is read


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


def one(database: sqlite3.Connection, query: str) -> Any:
    """Return the one row of a query; raises `DamagedError` when there is none."""
    row = database.execute(query).fetchone()
    if row is None:
        raise DamagedError("a part of it is missing")
    return row


def read_json(text: str, budget: Budget) -> Any:
    """Return what a text of JSON holds; raises `DamagedError` for one that cannot be read."""
    budget.take(JSON_BYTES * len(text))
    try:
        return json.loads(text)
    except (ValueError, RecursionError, MemoryError) as error:
        raise DamagedError("a setting cannot be read") from error
