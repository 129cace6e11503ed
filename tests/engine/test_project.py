from __future__ import annotations

import json
import os
import shutil
import sqlite3
import zlib
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from engine import project
from engine.controls import CONTROLS
from engine.errors import EngineError, FormatError
from engine.formats import livelink
from engine.performance import demo
from engine.project import Contents, Edit, InUseError, Media, Note, Project, Span, schema
from engine.speech.lane import VisemeLane, attached, renamed, restored, shifted, with_boundary
from engine.speech.visemes import Cue
from engine.take import SHAPES, Take
from tests.engine.projects import MARKS, an_edit, reopened, same, sample, sql

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


def test_steps_put_while_a_copy_is_made_are_in_the_copy(
    contents: Contents, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("engine.project.store.STEP_PAGES", 1)
    old, shares = project.create(tmp_path / "a.retake", replace(contents, edits=(), position=0)), []

    def report(share: float) -> None:
        shares.append(share)
        count = min(len(shares), len(contents.edits))
        old.put(replace(contents, edits=contents.edits[:count], position=count))

    new = old.save_as(tmp_path / "b.retake", report)
    assert len(new.contents.edits) == len(contents.edits) < len(shares) and shares[-1] == 1.0
    new.close()
    again = Project.open(tmp_path / "b.retake").contents
    assert [edit.title for edit in again.edits] == [edit.title for edit in contents.edits]
    for left, right in zip(again.edits, contents.edits, strict=True):
        np.testing.assert_array_equal(left.weights, right.weights)


def test_a_step_put_when_all_is_copied_is_missing_from_the_copy_and_known_to_be(
    contents: Contents, tmp_path: Path
) -> None:
    old = project.create(tmp_path / "a.retake", replace(contents, edits=(), position=0))

    def report(share: float) -> None:
        if share == 1.0:
            old.put(contents)

    new = old.save_as(tmp_path / "b.retake", report)
    assert new.contents.edits == ()
    new.put(contents)
    new.close()
    assert len(Project.open(tmp_path / "b.retake").contents.edits) == len(contents.edits)


@pytest.mark.parametrize("how", ["create", "save_as"])
def test_progress_grows_to_all_of_it_and_can_stop_the_work(contents: Contents, tmp_path: Path, how: str) -> None:
    work, shares = project.create(tmp_path / "work.retake", contents), []
    target = tmp_path / "b.retake"
    target.write_bytes(b"an older file")

    def write(report: Callable[[float], None]) -> Project:
        return project.create(target, contents, report) if how == "create" else work.save_as(target, report)

    def stop(share: float) -> None:
        raise EngineError("enough")

    with pytest.raises(EngineError, match="enough"):
        write(stop)
    assert target.read_bytes() == b"an older file" and len(list(tmp_path.glob(".*.part"))) == 0
    write(shares.append).close()
    assert shares == sorted(shares) and shares[-1] == 1.0


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
    summary = project.peek(path)
    assert (summary.name, summary.frames, summary.fps, summary.edits) == ("random", 40, 30.0, 3)
    assert abs((datetime.now(UTC) - summary.changed).total_seconds()) < 60
    sql(path, "UPDATE state SET changed = '2025-02-03T04:05:06'")
    assert project.peek(path).changed == datetime(2025, 2, 3, 4, 5, 6, tzinfo=UTC)
    sql(path, "UPDATE state SET changed = 'yesterday'")
    with pytest.raises(FormatError, match="last change"):
        project.peek(path)
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


def said(seed: int) -> list[tuple[Edit, VisemeLane | None, VisemeLane | None]]:
    """A random walk of steps on the visemes: attached, moved, named, shifted, restored, removed."""
    rng = np.random.default_rng(seed)
    lane, edits = None, []
    for step in range(20):
        turn = int(rng.integers(0, 8)) if lane is not None else 0
        if turn == 0:
            at = np.sort(rng.random(int(rng.integers(2, 9)))) * 5
            after = attached([Cue(a, b, "M") for a, b in pairwise(at)], f"{step}.TextGrid")
        elif turn == 1:
            after = None
        elif turn == 2:
            after = shifted(lane, float(rng.normal()))
        elif turn == 3:
            after = restored(lane)
        elif turn == 4:
            after = renamed(lane, int(rng.integers(0, len(lane.cues))), "AA1")
        else:
            after = with_boundary(lane, *lane.end_of(int(rng.integers(0, len(lane.cues)))), float(rng.random() * 5))
        edits.append((project.viseme_edit(f"step {step}", project.change_between(lane, after)), lane, after))
        lane = after
    return edits


def told(lane: VisemeLane | None) -> object:
    return None if lane is None else (lane.cues, lane.originals, lane.source, lane.offset_s)


@pytest.mark.parametrize("seed", range(6))
def test_every_step_on_the_visemes_comes_back_and_can_be_taken_back(
    seed: int, random_take: Take, tmp_path: Path
) -> None:
    steps = said(seed)
    edits = tuple(edit for edit, _, _ in steps)
    for position in (0, 7, len(edits)):
        path = tmp_path / f"{position}.retake"
        project.create(path, Contents(random_take, edits, position)).close()
        state = project.replay(reopened(path))
        assert told(state.visemes) == (told(steps[position - 1][2]) if position else None)
        for change, (_, before, after) in zip(state.changes, steps, strict=True):
            assert told(change.applied(before)) == told(after)
            assert told(change.inverse.applied(after)) == told(before)


def test_a_step_on_a_long_lane_is_small(random_take: Take) -> None:
    lane = attached([Cue(at / 10, at / 10 + 0.1, "M") for at in range(1000)], "long.TextGrid")
    for after in (renamed(lane, 500, "AA1"), with_boundary(lane, 500, 501, 50.12), shifted(lane, 1.0)):
        edit = project.viseme_edit("step", project.change_between(lane, after))
        assert len(json.dumps(dict(edit.inputs))) < 300


@pytest.mark.parametrize(
    "wrong",
    [
        {"at": 5},
        {"at": -1},
        {"at": "0"},
        {"removed": 2},
        {"added": [[0.0, 1.0]]},
        {"added": [[0.0, 1.0, "quux"]]},
        {"added": [[1.0, 0.0, "M"]]},
        {"added": [[0.0, 1e300, "M"]]},
        {"added": [[0.0, 2.0, "M"], [1.0, 3.0, "M"]]},
        {"added": 3},
        {"lane": {"source": 1, "offset_s": 0.0, "attached": True}},
        {"lane": {"source": "", "offset_s": "x", "attached": True}},
        {"lane": {"source": "", "offset_s": 0.0, "attached": False}},
        {"lane": 4},
        {"lane": {}},
    ],
)
def test_a_step_on_the_visemes_that_cannot_be_is_refused(
    wrong: dict[str, object], random_take: Take, tmp_path: Path
) -> None:
    (edit, *_), *_ = said(0)
    broken = replace(edit, inputs={**edit.inputs, **wrong})
    project.create(tmp_path / "a.retake", Contents(random_take, (broken,), 1)).close()
    with pytest.raises(FormatError, match="visemes"):
        Project.open(tmp_path / "a.retake")
