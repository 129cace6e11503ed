"""What is put in a project is there when it is opened again, whatever went wrong meanwhile."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from engine import project
from engine.controls import ALL_CONTROLS
from engine.errors import EngineError, FormatError
from engine.formats import livelink
from engine.lab.performer import demo
from engine.project import Contents, Edit, InUseError, Project, Verdict
from engine.take import SHAPES, Take
from tests.engine.project.projects import MARKS, an_edit, reopened, same, sql


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
            plain = replace(plain, marks=replace(MARKS, verdicts=(Verdict(f"{step}"),), spans=MARKS.spans[: step % 3]))
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


def test_a_full_disk_is_a_sentence_and_the_next_step_brings_what_is_missing(contents: Contents, tmp_path: Path) -> None:
    path = tmp_path / "a.retake"
    opened = project.create(path, contents)
    pages = opened._database.execute("PRAGMA page_count").fetchone()[0]
    opened._database.execute(f"PRAGMA max_page_count = {pages + 2}")
    take, frames = contents.original, len(contents.original)
    noise = np.random.default_rng(0).random((2, frames, len(SHAPES)))
    more = [Edit("fill", "fill", 0, rows, np.full((frames, len(ALL_CONTROLS)), np.nan)) for rows in noise]
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
    """Make what a kill of an earlier version left: a project whose last step only the log has."""
    elsewhere = folder.parent / f"{folder.name}-alive"
    elsewhere.mkdir()
    alive = project.create(elsewhere / "old.retake", contents)
    alive._database.execute("PRAGMA journal_mode = WAL").fetchone()
    alive._claim.note()
    alive.put(replace(contents, position=1))
    for name in ("old.retake", "old.retake-wal"):
        shutil.copyfile(elsewhere / name, folder / name)
    alive.close()
    return folder / "old.retake"


@pytest.mark.parametrize("how", ["create", "save_as"])
def test_a_save_over_a_killed_project_is_not_undone_by_its_log(contents: Contents, tmp_path: Path, how: str) -> None:
    path = left_by_a_kill(contents, tmp_path)
    new = replace(contents, position=2, marks=replace(MARKS, verdicts=(Verdict("Approved"),)))
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


def test_a_project_is_read_beside_the_program_that_has_it_open_and_left_as_it_was(
    contents: Contents, tmp_path: Path
) -> None:
    path = tmp_path / "a.retake"
    alive = project.create(path, contents)
    alive.put(replace(contents, position=1))
    before = {entry.name: entry.read_bytes() for entry in tmp_path.iterdir()}
    opened = Project.open(path, read_only=True)
    assert opened.read_only and opened.contents.position == 1
    with pytest.raises(EngineError, match="cannot be written"):
        opened.put(replace(opened.contents, position=0))
    assert {entry.name: entry.read_bytes() for entry in tmp_path.iterdir()} == before
    alive.put(contents)
    alive.close()
    assert same(reopened(path), contents)
