from __future__ import annotations

import json
import os
import shutil
import sqlite3
import zlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from engine import project
from engine.controls import CONTROLS
from engine.errors import EngineError, FormatError
from engine.formats import livelink
from engine.performance import demo
from engine.project import Contents, Edit, InUseError, Marks, Media, Note, Pin, Project, Span, schema
from engine.take import SHAPES, Take

MARKS = Marks(
    spans=(Span(3, 9), Span(0, 40, "lower", "lost")),
    pins=(Pin(5, {"jawOpen": 0.25, "mouthClose": 1 / 3}, 0, 12),),
    notes=(Note(7, "Ana 顔", "2025-01-02T03:04:05+01:00", "the lips\n'stay' open"),),
    media=(Media("audio", "sound/take.wav", "ab" * 32, -0.125),),
    verdict="needs work",
)
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


@pytest.fixture
def contents(random_take: Take) -> Contents:
    return sample(random_take)


def sample(take: Take) -> Contents:
    return Contents(take, tuple(an_edit(take, seed) for seed in range(4)), 3, MARKS)


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


def stored(contents: Contents, folder: Path) -> bytes:
    project.create(folder / "a.retake", contents).close()
    return (folder / "a.retake").read_bytes()


def an_edit(take: Take, seed: int) -> Edit:
    rng = np.random.default_rng(seed)
    start = int(rng.integers(0, len(take)))
    frames = int(rng.integers(0, len(take) - start + 1))
    asked = np.where(rng.random((frames, len(CONTROLS))) < 0.5, np.nan, rng.random((frames, len(CONTROLS))))
    inputs = {"radius_frames": seed, "exact": bool(seed % 2), "by_mm": np.float64(1 / 3), "curve": np.arange(3.0)}
    return Edit("drag", f"drag {seed} 'lips'", start, rng.random((frames, len(SHAPES))), asked, inputs)


def same(left: Contents, right: Contents) -> bool:
    ours, theirs = left.original, right.original
    assert (ours.fps, ours.name, ours.start_s) == (theirs.fps, theirs.name, theirs.start_s)
    for name in ("weights", "lost", "rotations"):
        np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name))
    assert (left.position, left.marks, len(left.edits)) == (right.position, right.marks, len(right.edits))
    for one, other in zip(left.edits, right.edits, strict=True):
        assert (one.kind, one.title, one.start) == (other.kind, other.title, other.start)
        as_json = [json.loads(json.dumps(dict(edit.inputs), default=np.ndarray.tolist)) for edit in (one, other)]
        assert as_json[0] == as_json[1]
        np.testing.assert_array_equal(one.weights, other.weights)
        np.testing.assert_array_equal(one.asked, other.asked)
    return True


def reopened(path: Path) -> Contents:
    opened = Project.open(path)
    opened.close()
    return opened.contents


def sql(path: Path, *statements: str, values: tuple[object, ...] = ()) -> None:
    database = sqlite3.connect(path)
    for statement in statements:
        database.execute(statement, values)
    database.commit()
    database.close()


def test_what_is_put_in_a_project_comes_out_bit_for_bit(contents: Contents, tmp_path: Path) -> None:
    project.create(tmp_path / "a.retake", contents).close()
    assert same(reopened(tmp_path / "a.retake"), contents)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.retake"]


@pytest.mark.parametrize("seed", range(4))
def test_a_walk_of_edits_undone_steps_and_marks_is_always_what_a_list_would_hold(
    seed: int, random_take: Take, tmp_path: Path
) -> None:
    rng = np.random.default_rng(seed)
    path = tmp_path / "walk.retake"
    plain = Contents(random_take)
    opened = project.create(path, plain)
    for step in range(25):
        turn = rng.random()
        if turn < 0.5:
            edits = (*plain.edits[: plain.position], an_edit(random_take, step))
            plain = replace(plain, edits=edits, position=len(edits))
        elif turn < 0.8:
            plain = replace(plain, position=int(rng.integers(0, len(plain.edits) + 1)))
        else:
            plain = replace(plain, marks=replace(MARKS, verdict=f"{step}", spans=MARKS.spans[: step % 3]))
        opened.put(plain)
        if rng.random() < 0.3:
            opened.close()
            opened = Project.open(path)
            assert same(opened.contents, plain)
            plain = opened.contents
    opened.close()
    assert same(reopened(path), plain)


def test_edits_that_are_safe_are_not_written_again(contents: Contents, tmp_path: Path) -> None:
    opened = project.create(tmp_path / "a.retake", contents)
    written: list[str] = []
    opened._database.set_trace_callback(written.append)
    opened.put(replace(contents, edits=(*contents.edits, an_edit(contents.original, 9)), position=5))
    opened.close()
    assert sum(statement.startswith("INSERT INTO edits") for statement in written) == 1
    assert not any("INTO take" in statement or "INTO spans" in statement for statement in written)


def test_replaying_equals_putting_edits_in_one_after_another(contents: Contents) -> None:
    for position in range(len(contents.edits) + 1):
        state = project.replay(replace(contents, position=position))
        take = contents.original
        asked = np.full((len(take), len(CONTROLS)), np.nan)
        for index, edit in enumerate(contents.edits):
            np.testing.assert_array_equal(state.before[index][0], take.weights[edit.start : edit.stop])
            np.testing.assert_array_equal(state.before[index][1], asked[edit.start : edit.stop])
            if index == position:
                np.testing.assert_array_equal(state.take.weights, take.weights)
                np.testing.assert_array_equal(state.asked, asked)
            take = take.with_rows(edit.start, edit.weights)
            asked[edit.start : edit.stop] = edit.asked
        if position == len(contents.edits):
            np.testing.assert_array_equal(state.take.weights, take.weights)


@pytest.mark.parametrize("newline", [b"\n", b"\r\n"])
def test_a_recording_with_lost_and_missed_rows_is_exported_from_a_project_byte_for_byte(
    tmp_path: Path, newline: bytes
) -> None:
    lines = demo.BUNDLED.read_bytes().split(b"\n")
    del lines[50]  # a missed frame, beside the lost ones that the demo take has
    (tmp_path / "recorded.csv").write_bytes(newline.join(lines))
    exports_alike(tmp_path / "recorded.csv", tmp_path)


def test_a_real_recording_is_exported_from_a_project_byte_for_byte(real_take_path: Path, tmp_path: Path) -> None:
    exports_alike(real_take_path, tmp_path)


def exports_alike(path: Path, folder: Path) -> None:
    take = livelink.read(path)
    project.create(folder / "a.retake", Contents(take)).close()
    stored = reopened(folder / "a.retake").original
    livelink.write(stored, folder / "untouched.csv")
    assert (folder / "untouched.csv").read_bytes() == path.read_bytes()
    rows = np.full((20, len(SHAPES)), 0.125)
    livelink.write(take.with_rows(30, rows), folder / "before.csv")
    livelink.write(stored.with_rows(30, rows), folder / "after.csv")
    assert (folder / "after.csv").read_bytes() == (folder / "before.csv").read_bytes() != path.read_bytes()


# --- versions


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


# --- what is no project, or a damaged one


def damaged(whole: bytes, path: Path, *statements: str, values: tuple[object, ...] = ()) -> str:
    path.write_bytes(whole)
    sql(path, *statements, values=values)
    with pytest.raises(FormatError) as caught:
        Project.open(path)
    assert path.name in caught.value.sentence and "Traceback" not in str(caught.value)
    return caught.value.sentence


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
    asked = zeros(40 * len(CONTROLS) * 8)
    statements = (
        "DELETE FROM edits",
        "INSERT INTO edits WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM n WHERE i < 5999) "
        f"SELECT i, 'a', 'b', '{{}}', 0, 40, x'{rows.hex()}', "
        f"'{json.dumps([control.name for control in CONTROLS])}', x'{asked.hex()}' FROM n",
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
    with pytest.raises(FormatError, match="not there"):
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


# --- writing


def test_a_full_disk_is_a_sentence_and_the_next_step_brings_what_is_missing(contents: Contents, tmp_path: Path) -> None:
    path = tmp_path / "a.retake"
    opened = project.create(path, contents)
    pages = opened._database.execute("PRAGMA page_count").fetchone()[0]
    opened._database.execute(f"PRAGMA max_page_count = {pages + 2}")
    take, frames = contents.original, len(contents.original)
    noise = np.random.default_rng(0).random((2, frames, len(SHAPES)))
    more = [Edit("fill", "fill", 0, rows, np.full((frames, len(CONTROLS)), np.nan)) for rows in noise]
    with pytest.raises(EngineError, match="no room left"):
        opened.put(Contents(take, (*contents.edits, more[0]), 5, MARKS))
    assert opened.contents is contents
    opened._database.execute("PRAGMA max_page_count = 1000000")
    final = Contents(take, (*contents.edits, *more), 6, MARKS)
    opened.put(final)
    opened.close()
    assert same(reopened(path), final)


def test_a_project_that_is_gone_is_a_sentence(contents: Contents, tmp_path: Path) -> None:
    opened = project.create(tmp_path / "a.retake", contents)
    (tmp_path / "a.retake").unlink()
    with pytest.raises(EngineError, match="moved or deleted"):
        opened.put(replace(contents, position=0))
    opened.close()


def test_a_folder_that_cannot_be_written_is_a_sentence(contents: Contents, tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    opened = project.create(tmp_path / "a.retake", contents)
    for write in (lambda path: project.create(path, contents), opened.save_as):
        with pytest.raises(EngineError, match=r"b\.retake could not be written"):
            write(tmp_path / "nowhere" / "b.retake")
        with pytest.raises(EngineError, match=r"b\.retake could not be written"):
            write(tmp_path / "file" / "b.retake")
    opened.close()


def test_what_cannot_be_written_can_be_read_with_the_steps_that_only_its_log_has(
    contents: Contents, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = left_by_a_kill(contents, tmp_path)
    monkeypatch.setattr(os, "access", lambda *_: False)
    before = {entry.name: entry.read_bytes() for entry in tmp_path.iterdir()}
    opened = Project.open(path)
    assert opened.read_only and opened.contents.position == 1
    with pytest.raises(EngineError, match="cannot be written"):
        opened.put(replace(opened.contents, position=0))
    assert {entry.name: entry.read_bytes() for entry in tmp_path.iterdir()} == before


def left_by_a_kill(contents: Contents, folder: Path) -> Path:
    """Make what a killed program leaves: a project whose last step only the log has."""
    elsewhere = folder.parent / f"{folder.name}-alive"
    elsewhere.mkdir()
    alive = project.create(elsewhere / "old.retake", contents)
    alive.put(replace(contents, position=1))
    for name in ("old.retake", "old.retake-wal"):
        shutil.copyfile(elsewhere / name, folder / name)
    alive.close()
    return folder / "old.retake"


@pytest.mark.parametrize("how", ["create", "save_as"])
def test_a_save_over_a_killed_project_is_not_undone_by_its_log(contents: Contents, tmp_path: Path, how: str) -> None:
    path = left_by_a_kill(contents, tmp_path)
    new = replace(contents, position=2, marks=replace(MARKS, verdict="approved"))
    if how == "create":
        project.create(path, new).close()
    else:
        work = project.create(tmp_path / "work.retake", new)
        work.save_as(path).close()
        work.close()
    assert same(reopened(path), new)


@pytest.mark.parametrize("how", ["create", "save_as"])
def test_a_save_that_fails_leaves_the_old_project_whole(
    contents: Contents, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, how: str
) -> None:
    path = left_by_a_kill(contents, tmp_path)
    work = project.create(tmp_path / "work.retake", contents)

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(EngineError, match="no space left"):
        project.create(path, contents) if how == "create" else work.save_as(path)
    monkeypatch.undo()
    work.close()
    assert reopened(path).position == 1
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["old.retake", "work.retake"]


def test_saving_as_goes_on_in_the_new_file_and_leaves_the_old_one(contents: Contents, tmp_path: Path) -> None:
    old = project.create(tmp_path / "a.retake", contents)
    new = old.save_as(tmp_path / "b.retake")
    assert old.save_as(tmp_path / "a.retake") is old
    new.put(replace(contents, position=0))
    old.close()
    new.close()
    assert (reopened(tmp_path / "a.retake").position, reopened(tmp_path / "b.retake").position) == (3, 0)


def test_a_project_that_is_open_is_left_alone_by_others(contents: Contents, tmp_path: Path) -> None:
    path = tmp_path / "a.retake"
    opened = project.create(path, contents)
    actions: list[Callable[[Path], object]] = [
        Project.open,
        project.peek,
        project.delete,
        lambda path: project.create(path, contents),
    ]
    for action in actions:
        with pytest.raises(InUseError, match="open in another Retake"):
            action(path)
    opened.close()
    assert project.peek(path).edits == 3
    project.delete(path)
    assert list(tmp_path.iterdir()) == []


# --- media


def test_media_are_found_in_their_place_beside_the_project_and_elsewhere(tmp_path: Path) -> None:
    folder, sound, other = tmp_path / "show", tmp_path / "show" / "sound", tmp_path / "other"
    for made in (sound, other):
        made.mkdir(parents=True)
    (sound / "take.wav").write_bytes(b"RIFF")
    media = project.attach(sound / "take.wav", folder, kind="audio", offset_s=0.5)
    assert (media.path, media.offset_s) == ("sound/take.wav", 0.5)
    assert project.find(media, folder).path == sound / "take.wav"
    for place in (folder / "take.wav", other / "take.wav"):
        found = next(tmp_path.rglob("take.wav"))
        found.rename(place)
        assert project.find(media, folder, [other]).path == place
    assert project.find(media, folder).sentence == "take.wav is missing."
    (folder / "take.wav").write_bytes(b"another")
    found_changed = project.find(media, folder)
    assert found_changed.path is None and found_changed.changed == folder / "take.wav"
    assert found_changed.sentence == "take.wav is not the file it was."
    assert project.attach(other / "take.wav", folder, kind="audio").path == "take.wav"
    with pytest.raises(FormatError, match=r"gone\.wav could not be read"):
        project.attach(folder / "gone.wav", folder, kind="audio")


@pytest.mark.parametrize(
    "place", ["../secret.wav", "link/secret.wav", "{outside}", "..\\secret.wav", "C:\\secret.wav", "a/../../secret.wav"]
)
def test_media_paths_never_lead_out_of_the_folder(tmp_path: Path, place: str) -> None:
    folder = tmp_path / "show"
    folder.mkdir()
    secret = tmp_path / "secret.wav"
    secret.write_bytes(b"RIFF")
    (folder / "link").symlink_to(tmp_path, target_is_directory=True)
    known = project.attach(secret, tmp_path, kind="audio")
    found = project.find(replace(known, path=place.format(outside=secret)), folder)
    assert found.path is None and found.changed is None and found.sentence == "secret.wav is missing."


@pytest.mark.parametrize("place", ["", ".", "..", "/", "a\x00b", "x" * 5000, "link/../..", "con:"])
def test_media_paths_that_are_no_paths_are_missing(tmp_path: Path, place: str) -> None:
    os.mkfifo(tmp_path / "pipe.wav")
    for path in (place, "pipe.wav"):
        assert project.find(Media("audio", path, "00"), tmp_path).path is None
