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
from engine.formats import livelink
from engine.performance import demo
from engine.project import Contents, Project
from engine.take import SHAPES, Take
from tests.engine.project.projects import reopened, sample, sql, stored


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A sound project file of 40 frames, four edits and every kind of mark."""
    rng = np.random.default_rng(3)
    take = Take(weights=rng.random((40, len(SHAPES))), fps=30.0, name="random")
    return stored(sample(take), tmp_path_factory.mktemp("whole"))


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A sound project file of a take that came from a recording."""
    return stored(Contents(livelink.read(demo.BUNDLED)), tmp_path_factory.mktemp("recorded"))


def damaged(whole: bytes, path: Path, *statements: str, values: tuple[object, ...] = ()) -> str:
    path.write_bytes(whole)
    sql(path, *statements, values=values)
    with pytest.raises(FormatError) as caught:
        Project.open(path)
    assert path.name in caught.value.sentence and "Traceback" not in str(caught.value)
    return caught.value.sentence


def marked(**marks: object) -> str:
    whole = {"spans": [], "pins": [], "notes": [], "media": [], "verdict": ""}
    return json.dumps({"before": whole, "after": {**whole, **marks}})


def zeros(count: int) -> bytes:
    return zlib.compress(bytes(count))


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
        ("UPDATE spans SET stop = ?", 41),
        ("UPDATE pins SET frame = ?", 12),
        ("UPDATE pins SET weights = ?", '{"jawOpen": "x"}'),
        ("UPDATE pins SET weights = ?", '{"jawOpen": NaN}'),
        ("UPDATE pins SET weights = ?", '{"nose": 1}'),
        ("UPDATE notes SET frame = ?", 40),
        ("UPDATE media SET offset_s = ?", -9e999),
    ],
)
def test_values_that_cannot_be_are_a_sentence(whole: bytes, tmp_path: Path, statement: str, value: object) -> None:
    assert "damaged" in damaged(whole, tmp_path / "a.retake", statement, values=(value,))


@pytest.mark.parametrize(
    ("statement", "value"),
    [
        ("UPDATE origin SET header = ?", "[]"),
        ("UPDATE origin SET header = ?", '["a,b", "c", "d"]'),
        ("UPDATE origin SET rows = ?", 10**12),
        ("UPDATE origin SET timecode_bytes = ?", -1),
        ("UPDATE origin SET timecodes = ?", zeros(9)),
        ("UPDATE origin SET decimals = ?", 10**6),
        ("UPDATE origin SET newline = ?", b"\x00"),
    ],
)
def test_an_origin_that_cannot_be_is_a_sentence(recorded: bytes, tmp_path: Path, statement: str, value: object) -> None:
    assert "damaged" in damaged(recorded, tmp_path / "a.retake", statement, values=(value,))


def test_a_small_file_cannot_fill_the_memory(whole: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("engine.project.blobs.ORDINARY_BYTES", 2**20)
    rows = zeros(40 * len(SHAPES) * 8)
    asked = zeros(40 * len(ALL_CONTROLS) * 8)
    statements = (
        "DELETE FROM edits",
        "INSERT INTO edits WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM n WHERE i < 5999) "
        f"SELECT i, 'a', 'b', '{{}}', 0, 40, x'{rows.hex()}', "
        f"'{json.dumps([control.name for control in ALL_CONTROLS])}', x'{asked.hex()}' FROM n",
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
