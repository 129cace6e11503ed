"""What is no project, or a damaged one, is one sentence; nothing in it is run, and it is left as it is."""

from __future__ import annotations

import json
import zlib
from pathlib import Path

import numpy as np
import pytest

from engine import project
from engine.controls import ALL_CONTROLS
from engine.errors import EngineError, FormatError
from engine.project import Contents, Project
from engine.take import SHAPES, Take
from tests.engine.project.damage import damaged, marked, zeros
from tests.engine.project.projects import reopened, sql, stored


@pytest.mark.parametrize(
    "statement",
    [
        "CREATE TRIGGER t AFTER INSERT ON edits BEGIN DELETE FROM take; END",
        "CREATE VIEW v AS SELECT * FROM take",
        "CREATE INDEX i ON edits (kind)",
        "CREATE TABLE more (x)",
        "ALTER TABLE notes ADD COLUMN y TEXT",
        "ALTER TABLE spans ADD COLUMN y BLOB AS (zeroblob(1000000000))",
        "DROP TABLE pins",
    ],
)
def test_other_tables_than_ours_are_refused_and_never_run(whole: bytes, tmp_path: Path, statement: str) -> None:
    assert "other tables" in damaged(whole, tmp_path / "a.retake", statement)


def test_a_newer_version_says_so(whole: bytes, tmp_path: Path) -> None:
    assert "newer Retake" in damaged(whole, tmp_path / "a.retake", "PRAGMA user_version = 99")


@pytest.mark.parametrize(
    ("statement", "value"),
    [
        ("UPDATE take SET frames = ?", 10**9),
        ("UPDATE take SET frames = ?", 900_000),
        ("UPDATE take SET frames = ?", -5),
        ("UPDATE take SET frames = ?", 41),
        ("UPDATE take SET fps = ?", 9e999),
        ("UPDATE take SET fps = ?", 0.0),
        ("UPDATE take SET weights = ?", b""),
        ("UPDATE take SET weights = ?", b"not deflated"),
        ("UPDATE take SET weights = ?", zeros(40 * 52 * 8 + 1)),
        ("UPDATE take SET weights = ?", zeros(40 * 52 * 8) + b"more"),
        ("UPDATE take SET weights = ?", zeros(40 * 52 * 8)[:-3]),
        ("UPDATE take SET weights = ?", zlib.compress(np.full((40, 52), np.nan).tobytes())),
        ("UPDATE take SET rotations = ?", zlib.compress(np.full((40, 9), np.inf).tobytes())),
        ("UPDATE take SET name = CAST(? AS TEXT)", b"\xff\xfe"),
        ("DELETE FROM take WHERE id = ?", 1),
        ("DELETE FROM state WHERE id = ?", 1),
        ("UPDATE state SET position = ?", 5),
        ("UPDATE state SET position = ?", -1),
        ("UPDATE edits SET start = ?", 40),
        ("UPDATE edits SET frames = ?", -1),
        ("UPDATE edits SET start = ?", 2**62),
        ("UPDATE edits SET place = place + ?", 100),
        ("UPDATE edits SET inputs = ?", "[" * 100_000),
        ("UPDATE edits SET inputs = ?", "[]"),
        ("UPDATE edits SET kind = ?", "mark"),
        ("UPDATE edits SET kind = 'mark', inputs = ?", '{"before": 3, "after": []}'),
        ("UPDATE edits SET kind = 'mark', inputs = ?", marked(spans=[{"start": 0, "stop": 99}])),
        ("UPDATE edits SET kind = 'mark', inputs = ?", marked(spans=[{"start": "0", "stop": 9}])),
        ("UPDATE edits SET kind = 'mark', inputs = ?", marked(spans=[{"start": 0.5, "stop": 9}])),
        ("UPDATE edits SET kind = 'mark', inputs = ?", marked(spans=[{"start": 0, "stop": 9, "region": []}])),
        ("UPDATE edits SET kind = 'mark', inputs = ?", marked(spans=[{"begin": 0}])),
        ("UPDATE edits SET kind = 'mark', inputs = ?", marked(verdict=5)),
        ("UPDATE edits SET controls = ?", "[1]"),
        ("UPDATE edits SET controls = ?", json.dumps(["a"] * 5000)),
        ("UPDATE edits SET asked = ?", zeros(7)),
        ("UPDATE edits SET lost = ?", zeros(700)),
        ("UPDATE spans SET stop = ?", 41),
        ("UPDATE pins SET frame = ?", 12),
        ("UPDATE pins SET weights = ?", '{"jawOpen": "x"}'),
        ("UPDATE pins SET weights = ?", '{"jawOpen": NaN}'),
        ("UPDATE pins SET weights = ?", '{"nose": 1}'),
        ("UPDATE notes SET frame = ?", 40),
        ("UPDATE notes SET frames = ?", 0),
        ("UPDATE notes SET frames = ?", 36),
        ("UPDATE notes SET replies = ?", '[{"author": "a"}]'),
        ("UPDATE notes SET replies = ?", '[{"author": 1, "time": "", "text": ""}]'),
        ("UPDATE notes SET replies = ?", "5"),
        ("UPDATE notes SET drawing = ?", '{"strokes": [[[0, 1, 2]]], "camera": []}'),
        ("UPDATE notes SET drawing = ?", '{"strokes": [[["a", 1]]], "camera": []}'),
        ("UPDATE notes SET drawing = ?", '{"strokes": [[[NaN, 1]]], "camera": []}'),
        ("UPDATE notes SET drawing = ?", '{"strokes": [], "camera": [1]}'),
        ("UPDATE notes SET drawing = ?", '{"strokes": 1, "camera": []}'),
        ("UPDATE dismissals SET stop = ?", 41),
        ("UPDATE dismissals SET weight = ?", 9e999),
        ("UPDATE flags SET counts = ?", 2),
        ("UPDATE flags SET threshold = ?", 9e999),
        ("UPDATE edits SET kind = 'mark', inputs = ?", marked(flags={"counts": {"lost": 1}})),
        ("UPDATE edits SET kind = 'mark', inputs = ?", marked(flags={"thresholds": {"open": "far"}})),
        ("UPDATE edits SET kind = 'mark', inputs = ?", marked(flags={"on": {}})),
        ("UPDATE edits SET kind = 'mark', inputs = ?", marked(flags={"counts": []})),
        ("UPDATE edits SET kind = 'mark', inputs = ?", marked(verdicts=[{"judgement": 5}])),
        ("UPDATE edits SET kind = 'mark', inputs = ?", marked(dismissals=[{"kind": "open"}])),
        ("UPDATE edits SET kind = 'mark', inputs = ?", marked(notes=[{"frame": 0, "replies": "ab"}])),
        ("UPDATE media SET offset_s = ?", -9e999),
    ],
)
def test_values_that_cannot_be_are_a_sentence(whole: bytes, tmp_path: Path, statement: str, value: object) -> None:
    assert "damaged" in damaged(whole, tmp_path / "a.retake", statement, values=(value,))


def test_a_small_file_cannot_fill_the_memory(whole: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("engine.project.blobs.ORDINARY_BYTES", 2**20)
    rows = zeros(40 * len(SHAPES) * 8)
    asked = zeros(40 * len(ALL_CONTROLS) * 8)
    statements = (
        "DELETE FROM edits",
        "INSERT INTO edits WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM n WHERE i < 5999) "
        f"SELECT i, 'a', 'b', '{{}}', 0, 40, x'{rows.hex()}', "
        f"'{json.dumps([control.name for control in ALL_CONTROLS])}', x'{asked.hex()}', NULL FROM n",
    )
    assert "more than it can hold" in damaged(whole, tmp_path / "a.retake", *statements)


@pytest.mark.parametrize(
    "content", [b"", b"\x89PNG\r\n\x1a\n" + bytes(2000), b"Timecode,BlendShapeCount\n", b"SQLite format 3\x00" * 50]
)
def test_other_files_are_a_sentence_and_stay_as_they_are(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.retake"
    path.write_bytes(content)
    for read in (Project.open, project.peek):
        with pytest.raises(FormatError, match=r"a\.retake"):
            read(path)
    assert path.read_bytes() == content
    with pytest.raises(FormatError, match="not there"):
        Project.open(tmp_path / "nowhere.retake")
    with pytest.raises(FormatError, match="is a folder"):
        Project.open(tmp_path)


def test_the_database_of_another_program_is_left_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "history.retake"
    sql(path, "CREATE TABLE visits (x)", "INSERT INTO visits VALUES (1)")
    before = path.read_bytes()
    with pytest.raises(FormatError, match="not a Retake project"):
        Project.open(path)
    assert path.read_bytes() == before and len(list(tmp_path.iterdir())) == 1


def test_flipped_and_missing_bytes_give_a_project_or_a_sentence(whole: bytes, tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    refused = 0
    for trial in range(150):
        broken = bytearray(whole)
        if trial % 3 == 0:
            del broken[int(rng.integers(0, len(broken))) :]
        else:
            for at in rng.integers(0, len(broken) if trial % 3 == 1 else 4096, 8):
                broken[at] = rng.integers(0, 256)
        path = tmp_path / f"{trial}.retake"
        path.write_bytes(broken)
        try:
            reopened(path)
        except EngineError as error:
            refused += 1
            assert error.sentence.endswith(".") and path.name in error.sentence
        for leavings in tmp_path.glob(f"{trial}.retake*"):
            leavings.unlink()
    assert refused > 75


def test_what_is_written_is_within_what_is_read_however_well_it_packs(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr("engine.project.blobs.ORDINARY_BYTES", 2**20)
    monkeypatch.setattr("engine.project.blobs.LARGE_BYTES", 2**16)
    still = Contents(Take(weights=np.zeros((20_000, len(SHAPES))), fps=60.0, name="still"))
    content = stored(still, tmp_path)
    (tmp_path / "b.retake").write_bytes(content)
    assert len(reopened(tmp_path / "b.retake").original) == 20_000
