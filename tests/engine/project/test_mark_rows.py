from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from engine.project.blobs import Budget, DamagedError
from engine.project.mark_rows import read_marks, read_verdict, write_marks
from engine.project.records import Marks, Pin, Span
from engine.project.reviewing import Verdict
from engine.project.schema import build
from engine.quality import FlagSettings
from tests.engine.project.projects import MARKS

FRAMES = 40


@pytest.fixture
def database(tmp_path: Path) -> Iterator[sqlite3.Connection]:
    connection = sqlite3.connect(tmp_path / "marks")
    build(connection)
    yield connection
    connection.close()


def read(database: sqlite3.Connection, length: int = FRAMES) -> Marks:
    return read_marks(database, length, Budget(1 << 20))


def test_every_mark_comes_back_as_it_was_and_in_its_order(database: sqlite3.Connection) -> None:
    write_marks(database, MARKS)
    assert read(database) == MARKS
    other_way = replace(MARKS, spans=MARKS.spans[::-1], notes=MARKS.notes[::-1], verdicts=MARKS.verdicts[::-1])
    write_marks(database, other_way)
    assert read(database) == other_way


def test_marks_are_put_in_place_of_those_that_are_there(database: sqlite3.Connection) -> None:
    write_marks(database, MARKS)
    few = Marks(spans=(Span(1, 2),), flags=FlagSettings({"pop": True}))
    write_marks(database, few)
    assert read(database) == few
    write_marks(database, Marks())
    assert read(database) == Marks()


def test_a_kind_of_flag_keeps_whether_it_counts_apart_from_its_threshold(database: sqlite3.Connection) -> None:
    settings = FlagSettings({"lost": False, "unlike": True}, {"unlike": 1.25, "open": 3.5})
    write_marks(database, Marks(flags=settings))
    assert read(database).flags == settings
    rows = database.execute("SELECT kind, counts, threshold FROM flags ORDER BY place").fetchall()
    assert rows == [("lost", 0, None), ("open", None, 3.5), ("unlike", 1, 1.25)]


def test_the_last_verdict_counts_unless_it_takes_the_others_back(database: sqlite3.Connection) -> None:
    assert read_verdict(database) is None
    write_marks(database, MARKS)
    assert read_verdict(database) == MARKS.verdicts[-1]
    write_marks(database, replace(MARKS, verdicts=(*MARKS.verdicts, Verdict(""))))
    assert read_verdict(database) is None and len(read(database).verdicts) == 3


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ("UPDATE flags SET counts = 2 WHERE kind = 'lost'", "neither counts nor does not"),
        ("UPDATE notes SET replies = '[{\"who\": 1}]'", "a reply or a drawing that is none"),
        ("UPDATE notes SET drawing = '{\"strokes\": []}'", "a reply or a drawing that is none"),
        ('UPDATE notes SET drawing = \'{"strokes": 3, "camera": []}\'', "a reply or a drawing that is none"),
        ("UPDATE spans SET stop = 41", "."),
        ("UPDATE pins SET frame = 40", "."),
        ("UPDATE pins SET weights = '{'", "a setting cannot be read"),
    ],
)
def test_what_cannot_be_is_damage(database: sqlite3.Connection, change: str, why: str) -> None:
    write_marks(database, MARKS)
    database.execute(change)
    with pytest.raises(DamagedError, match=why):
        read(database)


def test_a_verdict_that_is_none_is_damage_without_reading_anything_else(database: sqlite3.Connection) -> None:
    write_marks(database, MARKS)
    database.execute("UPDATE verdicts SET judgement = ?", ("so " * 100_000,))
    with pytest.raises(DamagedError):
        read_verdict(database)


def test_a_note_s_lists_are_read_within_the_memory_that_is_set_aside(database: sqlite3.Connection) -> None:
    write_marks(database, Marks(pins=(Pin(5, {"jawOpen": 0.25}, 0, 12),) * 50))
    budget = Budget(0)
    before = budget.left
    assert len(read_marks(database, FRAMES, budget).pins) == 50
    budget.left = before - budget.left - 1
    with pytest.raises(DamagedError, match="more than it can hold"):
        read_marks(database, FRAMES, budget)
