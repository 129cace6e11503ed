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
from engine.formats.livelink.origin import Origin
from engine.formats.livelink.writer import encode
from engine.lab.performer import demo
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


@pytest.mark.parametrize(
    ("statement", "value"),
    [
        ("UPDATE origin SET rows = ?", 10**12),
        ("UPDATE origin SET rows = ?", -1),
        ("UPDATE origin SET frames = ?", zeros(9)),
        ("UPDATE origin SET frames = ?", zeros(8 * 275)),
        ("UPDATE origin SET lost = ?", zlib.compress(bytes([1]) * 275)),
        ("UPDATE origin_text SET bytes = ?", 10**12),
        ("UPDATE origin_text SET bytes = ?", 0),
        ("UPDATE origin_text SET text = ?", zeros(9)),
        ("UPDATE origin_text SET place = place + ?", 1),
        ("DELETE FROM origin_text WHERE place = ?", 0),
        ("UPDATE origin_text SET bytes = 300, text = ?", zlib.compress(b"\xff\n" * 150)),
        ("UPDATE origin_text SET bytes = 300, text = ?", zlib.compress(b"a\n" * 150)),
        ("UPDATE origin_text SET bytes = 600, text = ?", zlib.compress(b"a\n" * 300)),
    ],
)
def test_an_origin_that_cannot_be_is_a_sentence(recorded: bytes, tmp_path: Path, statement: str, value: object) -> None:
    assert "damaged" in damaged(recorded, tmp_path / "a.retake", statement, values=(value,))


def test_a_take_whose_stored_text_is_no_row_is_written_all_the_same(recorded: bytes, tmp_path: Path) -> None:
    path = tmp_path / "a.retake"
    path.write_bytes(recorded)
    take = reopened(path).original
    assert isinstance(take.origin, Origin)
    head, *lines = take.origin.content.splitlines(keepends=True)
    text = head + b"".join(b"junk\n" if 20 <= index < 30 else line for index, line in enumerate(lines))
    sql(path, "UPDATE origin_text SET bytes = ?, text = ?", values=(len(text), zlib.compress(text)))
    opened = reopened(path).original
    edited = opened.with_rows(22, opened.weights[22:25] + 0.125)
    written = b"".join(encode(edited)).splitlines()
    assert len(written) == len(lines) + 1 and {len(line.split(b",")) for line in written[23:26]} == {63}


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


@pytest.mark.parametrize(
    ("statement", "value"),
    [
        ("UPDATE take SET fps = ?", 1e-320),
        ("UPDATE take SET fps = ?", 1e-4),
        ("UPDATE take SET start_s = ?", 1e300),
        (
            "UPDATE edits SET kind = 'mark', inputs = ?",
            marked(media=[{"kind": "audio", "path": "a", "sha256": "b"}] * 2),
        ),
        ("UPDATE media SET kind = ?", "anything"),
    ],
)
def test_times_and_kinds_that_cannot_be_are_a_sentence(whole: bytes, tmp_path: Path, statement: str, value) -> None:
    if "mark" in statement:
        value = value.replace('"sha256": "b"}', '"sha256": "b", "offset_s": [1, 2]}')
    assert "damaged" in damaged(whole, tmp_path / "a.retake", statement, values=(value,))


@pytest.mark.parametrize("offset", ["[1, 2]", '"1"', "null", "true", "1" + "0" * 400, "1e300", "{}"])
def test_an_offset_that_is_no_time_is_a_sentence_wherever_it_stands(whole: bytes, tmp_path: Path, offset: str) -> None:
    media = marked(media=[{"kind": "audio", "path": "a.wav", "sha256": "00", "offset_s": 0.125}]).replace(
        "0.125", offset
    )
    text = damaged(whole, tmp_path / "a.retake", "UPDATE edits SET kind = 'mark', inputs = ?", values=(media,))
    assert "damaged" in text


@pytest.mark.parametrize("date", ["0001-01-01T00:00:00+23:59", "9999-12-31T23:59:59-23:59", "", "tomorrow", "5" * 400])
def test_a_date_that_no_calendar_has_is_a_sentence(whole: bytes, tmp_path: Path, date: str) -> None:
    path = tmp_path / "a.retake"
    path.write_bytes(whole)
    sql(path, "UPDATE state SET changed = ?", values=(date,))
    with pytest.raises(FormatError, match="last change"):
        project.peek(path)


def test_what_is_written_is_within_what_is_read_however_well_it_packs(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr("engine.project.blobs.ORDINARY_BYTES", 2**20)
    monkeypatch.setattr("engine.project.blobs.LARGE_BYTES", 2**16)
    still = Contents(Take(weights=np.zeros((20_000, len(SHAPES))), fps=60.0, name="still"))
    content = stored(still, tmp_path)
    (tmp_path / "b.retake").write_bytes(content)
    assert len(reopened(tmp_path / "b.retake").original) == 20_000
