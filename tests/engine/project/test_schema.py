"""Older versions of the file open with all they hold."""

from __future__ import annotations

import json
import sqlite3
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from engine import project
from engine.errors import EngineError
from engine.formats import read_take, write_take
from engine.lab.performer import demo
from engine.project import Contents, Media, Note, Project, Span, Verdict, marks_of, replay, schema
from engine.take import SHAPES, runs
from tests.engine.project.projects import MARKS, reopened, same

# A file as the first version wrote it. Never to be changed: there are such files.
FIRST_VERSION = """
PRAGMA application_id = 1381256005;
PRAGMA user_version = 1;
CREATE TABLE take (
  id INTEGER PRIMARY KEY CHECK (id = 1),
  name TEXT NOT NULL, fps REAL NOT NULL, start_s REAL NOT NULL, frames INTEGER NOT NULL,
  weights BLOB NOT NULL, lost BLOB NOT NULL, rotations BLOB NOT NULL
) STRICT;
CREATE TABLE origin (
  id INTEGER PRIMARY KEY CHECK (id = 1),
  header TEXT NOT NULL, rows INTEGER NOT NULL, timecode_bytes INTEGER NOT NULL, timecodes BLOB NOT NULL,
  frames BLOB NOT NULL, recorded BLOB NOT NULL, lost BLOB NOT NULL,
  decimals INTEGER NOT NULL, newline BLOB NOT NULL, swapped INTEGER NOT NULL
) STRICT;
CREATE TABLE edits (
  place INTEGER PRIMARY KEY,
  kind TEXT NOT NULL, title TEXT NOT NULL, inputs TEXT NOT NULL,
  start INTEGER NOT NULL, frames INTEGER NOT NULL,
  weights BLOB NOT NULL, controls TEXT NOT NULL, asked BLOB NOT NULL
) STRICT;
CREATE TABLE state (
  id INTEGER PRIMARY KEY CHECK (id = 1),
  position INTEGER NOT NULL, verdict TEXT NOT NULL
) STRICT;
CREATE TABLE spans (
  place INTEGER PRIMARY KEY,
  start INTEGER NOT NULL, stop INTEGER NOT NULL, region TEXT NOT NULL, kind TEXT NOT NULL
) STRICT;
CREATE TABLE notes (
  place INTEGER PRIMARY KEY,
  frame INTEGER NOT NULL, author TEXT NOT NULL, time TEXT NOT NULL, text TEXT NOT NULL
) STRICT;
CREATE TABLE media (
  place INTEGER PRIMARY KEY,
  kind TEXT NOT NULL, path TEXT NOT NULL, sha256 TEXT NOT NULL
) STRICT;
"""


def test_a_file_of_the_first_version_opens_with_all_it_holds(contents: Contents, tmp_path: Path) -> None:
    path = tmp_path / "old.retake"
    take, edit = contents.original, contents.edits[1]
    database = sqlite3.connect(path)
    database.executescript(FIRST_VERSION)
    blobs = [zlib.compress(array.tobytes()) for array in (take.weights, take.lost, take.rotations)]
    database.execute("INSERT INTO take VALUES (1, 'random', 30.0, 0.0, 40, ?, ?, ?)", blobs)
    asked = edit.asked[:, [1, 0]]
    blobs = [zlib.compress(edit.weights.tobytes()), zlib.compress(np.ascontiguousarray(asked).tobytes())]
    database.execute(
        "INSERT INTO edits VALUES (0, 'drag', 'pull', '{\"exact\": true}', ?, ?, ?, '[\"lips_horizontal\", \"gone\"]', ?)",
        (edit.start, len(edit.weights), *blobs),
    )
    database.execute("INSERT INTO state VALUES (1, 1, 'approved')")
    database.execute("INSERT INTO spans VALUES (0, 3, 9, 'face', 'user')")
    database.execute("INSERT INTO notes VALUES (0, 5, 'Ana', '2024-05-06T07:08:09Z', 'here')")
    database.execute("INSERT INTO media VALUES (0, 'audio', 'a.wav', 'cd')")
    database.commit()
    database.close()

    before = path.read_bytes()
    assert same(Project.open(path, read_only=True).contents, Project.open(path, read_only=True).contents)
    assert path.read_bytes() == before and [entry.name for entry in tmp_path.iterdir()] == ["old.retake"]
    found = reopened(path)
    np.testing.assert_array_equal(found.original.weights, take.weights)
    np.testing.assert_array_equal(found.edits[0].weights, edit.weights)
    np.testing.assert_array_equal(found.edits[0].asked[:, 1], edit.asked[:, 1])  # the controls go by name
    assert np.isnan(np.delete(found.edits[0].asked, 1, axis=1)).all()
    assert found.edits[0].inputs == {"exact": True}
    assert found.marks.media == (Media("audio", "a.wav", "cd", 0.0),)
    assert (found.marks.spans, found.marks.pins, found.marks.verdict) == ((Span(3, 9),), (), "approved")
    assert found.marks.notes == (Note(5, "Ana", "2024-05-06T07:08:09Z", "here"),)
    opened = Project.open(path)  # it is of the newest version now, to the letter
    assert schema.check(opened._database, path.name) == schema.VERSION
    opened.put(replace(opened.contents, marks=MARKS))
    opened.close()
    assert reopened(path).marks == MARKS


# As the second version wrote it. Never to be changed either.
SECOND_VERSION = (
    FIRST_VERSION.replace("user_version = 1", "user_version = 2")
    .replace(
        "position INTEGER NOT NULL, verdict TEXT NOT NULL",
        "position INTEGER NOT NULL, verdict TEXT NOT NULL, changed TEXT NOT NULL",
    )
    .replace("sha256 TEXT NOT NULL", "sha256 TEXT NOT NULL, offset_s REAL NOT NULL")
    + """
CREATE TABLE pins (
  place INTEGER PRIMARY KEY,
  frame INTEGER NOT NULL, weights TEXT NOT NULL, start INTEGER NOT NULL, stop INTEGER NOT NULL
) STRICT;
"""
)


def test_a_take_in_a_file_of_the_second_version_is_written_as_it_came_and_its_fill_with_it(tmp_path: Path) -> None:
    """The second version kept the values of the file and their decimals, and of an edit not what it found."""
    path, take = tmp_path / "old.retake", read_take(demo.BUNDLED)
    lines = demo.BUNDLED.read_bytes().splitlines()
    header, rows = lines[0].decode().split(","), [line.split(b",") for line in lines[1:]]
    lost = np.array([row[1] == b"0" for row in rows])
    recorded = np.array([np.zeros(61) if len(row) == 2 else np.array(row[2:], float) for row in rows])
    start, stop = runs(take.lost)[0]
    filled = np.random.default_rng(0).random((stop - start, len(SHAPES)))
    timecodes = b"\n".join(row[0] for row in rows)
    database = sqlite3.connect(path)
    database.executescript(SECOND_VERSION)
    packed = zlib.compress
    blobs = [packed(array.tobytes()) for array in (take.weights, take.lost, take.rotations)]
    database.execute(
        "INSERT INTO take VALUES (1, 'demo', ?, ?, ?, ?, ?, ?)", (take.fps, take.start_s, len(take), *blobs)
    )
    blobs = [packed(array.tobytes()) for array in (np.arange(len(rows)), recorded, lost)]
    database.execute(
        "INSERT INTO origin VALUES (1, ?, ?, ?, ?, ?, ?, ?, 10, x'0a', 1)",
        (json.dumps(header), len(rows), len(timecodes), packed(timecodes), *blobs),
    )
    asked = packed(np.full((stop - start, 1), np.nan).tobytes())
    database.execute(
        "INSERT INTO edits VALUES (0, 'fill', 'fill', '{}', ?, ?, ?, '[\"lips_vertical\"]', ?)",
        (start, stop - start, packed(filled.tobytes()), asked),
    )
    database.execute("INSERT INTO state VALUES (1, 1, '', '2025-01-02T03:04:05Z')")
    database.commit()
    database.close()

    found = reopened(path)
    write_take(found.original, tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_bytes() == demo.BUNDLED.read_bytes()
    write_take(replay(found).take, tmp_path / "filled.csv")
    again = read_take(tmp_path / "filled.csv")
    assert not again.lost.any()
    np.testing.assert_allclose(again.weights[start:stop], filled, atol=1e-10)


# As the third version wrote it. Never to be changed either.
THIRD_VERSION = (
    SECOND_VERSION.replace("user_version = 2", "user_version = 3")
    .replace("asked BLOB NOT NULL\n", "asked BLOB NOT NULL, lost BLOB\n")
    .replace(
        """  header TEXT NOT NULL, rows INTEGER NOT NULL, timecode_bytes INTEGER NOT NULL, timecodes BLOB NOT NULL,
  frames BLOB NOT NULL, recorded BLOB NOT NULL, lost BLOB NOT NULL,
  decimals INTEGER NOT NULL, newline BLOB NOT NULL, swapped INTEGER NOT NULL
""",
        "  rows INTEGER NOT NULL, frames BLOB NOT NULL, lost BLOB NOT NULL, swapped INTEGER NOT NULL\n",
    )
    + """
CREATE TABLE origin_text (
  place INTEGER PRIMARY KEY,
  bytes INTEGER NOT NULL, text BLOB NOT NULL
) STRICT;
"""
)


@pytest.mark.parametrize(
    ("told", "verdicts"),
    [
        ("Needs work: the jaw: it pops", (Verdict("Needs work", "the jaw: it pops"),)),
        ("Approved", (Verdict("Approved"),)),
        ("", ()),
    ],
)
def test_notes_verdict_and_marked_steps_of_the_third_version_are_kept(
    contents: Contents, tmp_path: Path, told: str, verdicts: tuple[Verdict, ...]
) -> None:
    path, take = tmp_path / "old.retake", contents.original
    database = sqlite3.connect(path)
    database.executescript(THIRD_VERSION)
    blobs = [zlib.compress(array.tobytes()) for array in (take.weights, take.lost, take.rotations)]
    database.execute("INSERT INTO take VALUES (1, 'random', 30.0, 0.0, 40, ?, ?, ?)", blobs)
    marks = {"spans": [], "pins": [], "notes": [], "media": [], "verdict": ""}
    note = {"frame": 5, "author": "Ana", "time": "2024-05-06T07:08:09Z", "text": "here"}
    inputs = json.dumps({"before": marks, "after": {**marks, "notes": [note], "verdict": told}})
    nothing = zlib.compress(b"")
    database.execute(
        "INSERT INTO edits VALUES (0, 'mark', 'note', ?, 0, 0, ?, '[\"lips_vertical\"]', ?, NULL)",
        (inputs, nothing, nothing),
    )
    database.execute("INSERT INTO state VALUES (1, 1, ?, '2025-01-02T03:04:05Z')", (told,))
    database.execute("INSERT INTO notes VALUES (0, 5, 'Ana', '2024-05-06T07:08:09Z', 'here')")
    database.commit()
    database.close()

    judgement = verdicts[0] if verdicts else None
    assert project.peek(path).verdict == judgement  # the old file is only looked at
    found = reopened(path)
    assert project.peek(path).verdict == judgement
    assert found.marks == marks_of(found.edits[0].inputs["after"])
    assert found.marks.notes == (Note(5, "Ana", "2024-05-06T07:08:09Z", "here"),)
    assert found.marks.verdicts == verdicts and found.marks.verdict == told


def test_each_older_version_has_a_way_to_the_next() -> None:
    assert sorted(schema.MIGRATIONS) == list(range(1, schema.VERSION))
    assert sorted(schema.SCHEMAS) == list(range(1, schema.VERSION + 1))


def test_a_migration_cut_short_leaves_the_file_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "old.retake"
    database = sqlite3.connect(path)
    database.executescript(FIRST_VERSION)
    database.close()
    monkeypatch.setitem(schema.MIGRATIONS, 1, (*schema.MIGRATIONS[1], "DROP TABLE nowhere"))
    with pytest.raises(EngineError):
        Project.open(path)
    database = sqlite3.connect(path)
    assert schema.check(database, "old.retake") == 1
    database.close()
