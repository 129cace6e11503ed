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
from engine.project import Contents, Media, Note, Project, Span, Verdict, marks_of, schema
from tests.engine.project.projects import MARKS, reopened, same
from tests.engine.project.versions import FIRST_VERSION, SECOND_VERSION


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
