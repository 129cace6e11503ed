"""A project that somebody else replaces, deletes or opens while it is open: nothing is lost, and nobody's file harmed."""

from __future__ import annotations

import multiprocessing
import os
import shutil
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from multiprocessing.synchronize import Event
from pathlib import Path

import numpy as np
import pytest

from engine import project
from engine.project import Contents, DisplacedError, InUseError, Project, database
from engine.take import SHAPES, Take
from tests.engine.project.projects import an_edit, reopened, same

REPLACED = {
    "renamed over": os.replace,
    "deleted and made anew": lambda new, path: (path.unlink(), shutil.copyfile(new, path)),
    "written over": lambda new, path: path.write_bytes(new.read_bytes()),
}


@pytest.fixture
def newcomer(tmp_path: Path) -> Path:
    """Another project that is ready to take the place of the one that is open."""
    rng = np.random.default_rng(8)
    take = Take(weights=rng.random((60, len(SHAPES))), fps=24.0, name="newcomer")
    (tmp_path / "elsewhere").mkdir()
    project.create(tmp_path / "elsewhere" / "new.retake", Contents(take, (an_edit(take, 3),), 1)).close()
    return tmp_path / "elsewhere" / "new.retake"


def others(folder: Path) -> list[str]:
    return sorted(entry.name for entry in folder.iterdir() if entry.is_file())


@pytest.mark.parametrize("how", REPLACED)
def test_a_project_that_was_replaced_is_never_written(
    contents: Contents, tmp_path: Path, newcomer: Path, how: str
) -> None:
    path, wanted = tmp_path / "a.retake", newcomer.read_bytes()
    opened = project.create(path, contents)
    opened.put(replace(contents, position=1))
    REPLACED[how](newcomer, path)
    for _ in range(2):
        with pytest.raises(DisplacedError, match="by another program"):
            opened.put(replace(contents, position=2))
    with pytest.raises(DisplacedError):
        opened.check()
    assert opened.contents.position == 1
    opened.close()
    assert path.read_bytes() == wanted and others(tmp_path) == ["a.retake"]
    assert reopened(path).original.name == "newcomer"


def test_a_project_that_was_replaced_can_be_saved_elsewhere(contents: Contents, tmp_path: Path, newcomer: Path) -> None:
    opened = project.create(tmp_path / "a.retake", contents)
    os.replace(newcomer, tmp_path / "a.retake")
    with pytest.raises(DisplacedError):
        opened.save_as(tmp_path / "b.retake")
    project.create(tmp_path / "b.retake", contents).close()
    opened.close()
    assert same(reopened(tmp_path / "b.retake"), contents)


@pytest.mark.parametrize("seed", range(4))
def test_a_copy_of_the_file_alone_holds_every_step(contents: Contents, tmp_path: Path, seed: int) -> None:
    opened = project.create(tmp_path / "a.retake", replace(contents, edits=(), position=0))
    for step in range(4):
        edits = (*opened.contents.edits, an_edit(contents.original, 10 * seed + step))
        opened.put(replace(opened.contents, edits=edits, position=len(edits)))
        shutil.copyfile(tmp_path / "a.retake", tmp_path / f"mailed{step}.retake")
        assert same(reopened(tmp_path / f"mailed{step}.retake"), opened.contents)
    opened.close()


def test_a_link_to_a_project_is_one_project_and_stays_a_link(contents: Contents, tmp_path: Path) -> None:
    path, link = tmp_path / "a.retake", tmp_path / "link.retake"
    project.create(path, contents).close()
    link.symlink_to(path)
    opened = Project.open(link)
    with pytest.raises(InUseError):
        Project.open(path)
    opened.put(replace(opened.contents, position=1))
    opened.close()
    project.create(link, replace(contents, position=2)).close()
    assert link.is_symlink() and reopened(path).position == 2


# --- file systems without locks, other computers


@pytest.fixture
def without_locks(monkeypatch: pytest.MonkeyPatch) -> None:
    """A file system that grants SQLite every lock it asks for."""
    connect = sqlite3.connect

    def granted(address: str, **options: object) -> sqlite3.Connection:
        return connect(str(address).replace("mode=rw", "mode=rw&nolock=1"), **options)

    monkeypatch.setattr(database.sqlite3, "connect", granted)


@pytest.mark.usefixtures("without_locks")
def test_without_locks_of_the_file_system_there_is_one_writer_all_the_same(contents: Contents, tmp_path: Path) -> None:
    path = tmp_path / "a.retake"
    first = project.create(path, contents)
    both: list[Callable[[], object]] = [
        lambda: Project.open(path),
        lambda: project.create(path, contents),
        lambda: project.delete(path),
        lambda: project.peek(path),
    ]
    for another in both:
        with pytest.raises(InUseError, match="another Retake"):
            another()
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply(_is_open_elsewhere, (path,))
    first.put(replace(contents, position=1))
    first.close()
    assert reopened(path).position == 1


def _is_open_elsewhere(path: Path) -> bool:
    try:
        Project.open(path).close()
    except InUseError:
        return True
    return False


# --- kills


def _within_a_step(path: Path, spares: Path, ready: Event) -> None:
    opened = Project.open(path)
    opened.keep_spare(spares)
    ready.set()
    database = opened._database
    database.execute("PRAGMA cache_size = 1")  # pages go to the file before the step is finished
    database.execute("BEGIN IMMEDIATE")
    database.execute("UPDATE take SET weights = zeroblob(length(weights)), name = 'half done'")
    database.execute("UPDATE edits SET weights = zeroblob(length(weights))")
    ready.set()
    multiprocessing.Event().wait()


@contextmanager
def killed_within_a_step(path: Path) -> Iterator[Path]:
    """Leave what a kill leaves in the middle of writing a step."""
    context, spares = multiprocessing.get_context("spawn"), path.parent / "unsaved"
    ready = context.Event()
    process = context.Process(target=_within_a_step, args=(path, spares, ready))
    process.start()
    try:
        assert ready.wait(60)
        ready.clear()
        assert ready.wait(60)
    finally:
        process.kill()
        process.join()
    assert path.with_name(f"{path.name}-journal").read_bytes()[:1] not in (b"", b"\0")
    yield spares


def test_what_a_kill_within_a_step_leaves_opens_without_the_step(contents: Contents, tmp_path: Path) -> None:
    project.create(path := tmp_path / "a.retake", contents).close()
    with killed_within_a_step(path):
        assert same(Project.open(path, read_only=True).contents, contents)
        assert same(reopened(path), contents)
        assert others(tmp_path) == ["a.retake"]


def test_a_folder_that_is_copied_after_a_kill_opens_without_the_step(contents: Contents, tmp_path: Path) -> None:
    (folder := tmp_path / "one").mkdir()
    project.create(path := folder / "a.retake", contents).close()
    with killed_within_a_step(path):
        shutil.copytree(folder, tmp_path / "two")
        assert same(reopened(tmp_path / "two" / "a.retake"), contents)


@pytest.mark.parametrize("how", ["open", "create", "recover"])
def test_what_a_kill_leaves_is_never_applied_to_a_newcomer(
    contents: Contents, tmp_path: Path, newcomer: Path, how: str
) -> None:
    project.create(path := tmp_path / "a.retake", contents).close()
    wanted = reopened(newcomer)
    with killed_within_a_step(path) as spares:
        os.replace(newcomer, path)
        if how == "create":
            project.create(path, wanted).close()
        elif how == "recover":
            project.recover(spares, lambda: spares / "rescued.retake")
            assert same(reopened(spares / "rescued.retake"), contents)
        assert same(reopened(path), wanted)
        assert others(tmp_path) == ["a.retake"]


def _step_and_wait(path: Path, spares: Path, ready: Event) -> None:
    opened = Project.open(path)
    opened.keep_spare(spares)
    opened.put(replace(opened.contents, position=1))
    ready.set()
    multiprocessing.Event().wait()


@pytest.mark.parametrize("how", ["renamed over", "deleted", "nothing"])
def test_a_project_that_is_replaced_under_a_program_which_is_then_killed_is_found_at_the_next_start(
    contents: Contents, tmp_path: Path, newcomer: Path, how: str
) -> None:
    project.create(path := tmp_path / "a.retake", contents).close()
    context, spares = multiprocessing.get_context("spawn"), tmp_path / "unsaved"
    ready = context.Event()
    process = context.Process(target=_step_and_wait, args=(path, spares, ready))
    process.start()
    try:
        assert ready.wait(60)
        project.recover(spares, lambda: spares / "rescued.retake")
        assert len(list(spares.iterdir())) == 2  # its program still runs
        if how == "renamed over":
            os.replace(newcomer, path)
        elif how == "deleted":
            path.unlink()
    finally:
        process.kill()
        process.join()
    project.recover(spares, lambda: spares / "rescued.retake")
    assert others(spares) == ([] if how == "nothing" else ["rescued.retake"])
    assert others(tmp_path) == ([] if how == "deleted" else ["a.retake"])
    found = path if how == "nothing" else spares / "rescued.retake"
    assert same(reopened(found), replace(contents, position=1))
