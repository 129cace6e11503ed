from __future__ import annotations

import sqlite3
from collections.abc import Iterator

import pytest

from engine.project.blobs import Budget, DamagedError
from engine.project.tables import insert, one, read_json


@pytest.fixture
def database() -> Iterator[sqlite3.Connection]:
    opened = sqlite3.connect(":memory:")
    opened.execute("CREATE TABLE parts (place INTEGER PRIMARY KEY, name TEXT, first BLOB, second BLOB)")
    yield opened
    opened.close()


def test_a_row_holds_its_blobs_piece_after_piece(database: sqlite3.Connection) -> None:
    insert(database, "parts", (7, "a", [b"one", b"", b"two"], b"whole"))
    insert(database, "parts", (2, None, [], [b"x" * 100_000, b"y"]))
    rows = database.execute("SELECT * FROM parts ORDER BY place").fetchall()
    assert rows == [(2, None, b"", b"x" * 100_000 + b"y"), (7, "a", b"onetwo", b"whole")]


def test_the_one_row_of_a_query_or_damage(database: sqlite3.Connection) -> None:
    insert(database, "parts", (7, "a", b"", b""))
    assert one(database, "SELECT place, name FROM parts") == (7, "a")
    with pytest.raises(DamagedError, match="a part of it is missing"):
        one(database, "SELECT place FROM parts WHERE place = 8")


def test_json_is_paid_for_by_its_letters_and_damage_where_it_is_none() -> None:
    budget = Budget(0)
    before = budget.left
    assert read_json('{"a": [1]}', budget) == {"a": [1]}
    assert before - budget.left == 32 * 10
    for text in ("{", "[" * 100_000, "nothing"):
        with pytest.raises(DamagedError, match="a setting cannot be read"):
            read_json(text, budget)
    budget.left = 31
    with pytest.raises(DamagedError, match="more than it can hold"):
        read_json("1", budget)
