"""Somebody replaces or deletes the project while it is open: the work goes on elsewhere, and nobody's file is harmed."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from multiprocessing.synchronize import Event
from pathlib import Path

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.session import Session
from app.session.keeper import Keeper
from app.session.opening import Wish, opened
from engine import project
from engine.formats import write_take
from engine.live.record import Recorder
from engine.live.spool import Spool
from engine.live.stream import Arrival
from engine.project import Contents, InUseError, Project
from engine.take import SHAPES, Take
from tests.app.session.test_keeper import Made, alike, kept, make, push, refused, saved
from tests.performance import kills, sessions

__all__ = ["make"]  # a fixture


@pytest.fixture
def newcomer(tmp_path: Path) -> Path:
    (tmp_path / "elsewhere").mkdir()
    path = tmp_path / "elsewhere" / "new.retake"
    project.create(path, Contents(Take(weights=np.zeros((9, len(SHAPES))), fps=24.0, name="newcomer"))).close()
    return path


def displaced(qtbot: QtBot, keeper: Keeper, notice: Callable[[], object]) -> str:
    with qtbot.waitSignal(keeper.failed, timeout=10_000) as told:
        notice()
    qtbot.waitUntil(lambda: keeper._work.idle, timeout=10_000)
    assert "unsaved work" in told.args[1]
    return str(told.args[0])


@pytest.mark.parametrize("how", ["replaced", "deleted"])
@pytest.mark.parametrize("noticed", ["at the next step", "by itself"])
def test_all_of_the_work_goes_on_as_unsaved_work(
    qtbot: QtBot, make: Made, tmp_path: Path, newcomer: Path, how: str, noticed: str
) -> None:
    first, path, wanted = make(), tmp_path / "a.retake", newcomer.read_bytes()
    push(first._session, 1)
    saved(qtbot, first, path)
    kept(qtbot, first, lambda: push(first._session, 2))
    os.replace(newcomer, path) if how == "replaced" else path.unlink()
    step = (lambda: push(first._session, 3)) if noticed == "at the next step" else first._looks.timeout.emit
    assert f"a.retake was {'replaced by' if how == 'replaced' else 'moved or'}" in displaced(qtbot, first, step)
    assert first.path is None and first._session.document.edited
    kept(qtbot, first, lambda: push(first._session, 4))
    session = first._session
    first.close()
    assert (path.read_bytes() == wanted) if how == "replaced" else not path.exists()
    assert sorted(entry.name for entry in tmp_path.iterdir() if entry.is_file()) == (["a.retake"] * (how == "replaced"))

    second = make()
    (left,) = second.left_over()
    second.open(opened(second._session, Wish(left.path, left_over=True)))
    assert alike(session, second._session) and second._session.document.undo.count() == 3 + (
        noticed == "at the next step"
    )


def test_saving_anew_does_not_replace_a_newcomer_unasked_and_does_when_asked(
    qtbot: QtBot, make: Made, tmp_path: Path, newcomer: Path
) -> None:
    first, path, wanted = make(), tmp_path / "a.retake", newcomer.read_bytes()
    push(first._session, 1)
    saved(qtbot, first, path)
    os.replace(newcomer, path)
    assert "replaced by another program" in refused(qtbot, first, path)
    qtbot.waitUntil(lambda: first._session.document.edited, timeout=10_000)
    assert path.read_bytes() == wanted and first.path is None
    saved(qtbot, first, path)  # the file dialog asked now: the name is no more that of the open project
    assert first.path == path and not first._session.document.edited
    first.close()
    assert len(Project.open(path, read_only=True).contents.edits) == 1
    assert list((tmp_path / "data" / "unsaved").iterdir()) == []


def test_a_project_that_was_deleted_is_saved_anew_in_its_place(qtbot: QtBot, make: Made, tmp_path: Path) -> None:
    first, path = make(), tmp_path / "a.retake"
    push(first._session, 1)
    saved(qtbot, first, path)
    path.unlink()
    saved(qtbot, first, path)
    first.close()
    assert len(Project.open(path, read_only=True).contents.edits) == 1
    assert list((tmp_path / "data" / "unsaved").iterdir()) == []


def test_after_a_save_the_file_alone_is_what_was_saved(qtbot: QtBot, make: Made, tmp_path: Path) -> None:
    first, path = make(), tmp_path / "a.retake"
    for seed in range(3):
        push(first._session, seed)
        saved(qtbot, first, path)
        (tmp_path / "mailed.retake").write_bytes(path.read_bytes())
        assert len(Project.open(tmp_path / "mailed.retake", read_only=True).contents.edits) == seed + 1


def test_another_program_does_not_take_a_recording_that_is_still_made(make: Made, tmp_path: Path) -> None:
    folder, recorder = tmp_path / "data" / "unsaved", Recorder()
    folder.mkdir(parents=True)
    rng = np.random.default_rng(4)
    weights = rng.random((200, len(SHAPES))).astype(np.float32)
    for index, row in enumerate(weights):
        recorder.add(Arrival(index / 60, 60.0, row, np.zeros(9, np.float32), late=False))
    spool = Spool(recorder, folder / "live.csv")
    spool.save(all_rows=True)
    os.utime(spool.path, (1.0, 1.0))  # suspended for long, or the clock was set
    watcher = make()
    assert watcher.left_over() == [] and spool.path.exists()
    spool.close(remove=False)
    whole = spool.path.read_bytes()
    spool.path.write_bytes(whole[: whole.rindex(b"\n", 0, -1) + 200] + b"\0" * 4096)  # as a power cut leaves it
    (left,) = watcher.left_over()
    watcher.open(opened(watcher._session, Wish(left.path, left_over=True)))
    np.testing.assert_allclose(watcher._session.document.take.weights, weights[:-1], atol=1e-9)
    assert not list(folder.glob("*.csv"))


def test_a_recording_of_nothing_leaves_nothing(make: Made, tmp_path: Path) -> None:
    folder = tmp_path / "data" / "unsaved"
    folder.mkdir(parents=True)
    Spool(Recorder(), folder / "live.csv").close(remove=False)
    (folder / "other.partial.csv").write_bytes(b"somebody's own table\n1,2\n")
    assert make().left_over() == []
    assert [entry.name for entry in folder.iterdir()] == ["other.partial.csv"]


def _edit_and_wait(folder: Path, path: Path, ready: Event) -> None:
    from PySide6.QtCore import QCoreApplication

    application = QCoreApplication([])
    keeper = Keeper(Session(Take(weights=np.zeros((50, len(SHAPES))), fps=30.0, name="killed")), folder)
    safe: list[Contents] = []
    keeper.kept.connect(safe.append)
    push(keeper._session, 1)
    keeper.save_as(path)
    while keeper.path is None:
        application.processEvents()
    push(keeper._session, 2)
    while not safe or len(safe[-1].edits) < 2:
        application.processEvents()
    ready.set()
    multiprocessing.Event().wait()


def test_a_project_that_is_replaced_just_before_a_kill_is_offered_with_every_step(
    make: Made, tmp_path: Path, newcomer: Path
) -> None:
    context, path, wanted = multiprocessing.get_context("spawn"), tmp_path / "a.retake", newcomer.read_bytes()
    ready = context.Event()
    process = context.Process(target=_edit_and_wait, args=(tmp_path / "data" / "unsaved", path, ready))
    process.start()
    try:
        assert ready.wait(60)
        os.replace(newcomer, path)
    finally:
        process.kill()
        process.join()
    watcher = make()
    (left,) = watcher.left_over()
    assert (left.name, left.edits) == ("killed", 2)
    assert path.read_bytes() == wanted
    assert sorted(entry.name for entry in tmp_path.iterdir() if entry.is_file()) == ["a.retake"]
    assert [entry for entry in (tmp_path / "data" / "unsaved").iterdir()] == [left.path]


@pytest.mark.parametrize("kind", ["replace", "export", "record"])
@pytest.mark.parametrize("seed", range(3))
def test_a_kill_loses_nothing_that_was_reported_and_leaves_nothing_stray(seed: int, tmp_path: Path, kind: str) -> None:
    kills.check(seed, tmp_path, kind)


@pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="signals of Unix")
def test_a_suspended_program_keeps_what_it_has_and_goes_on(make: Made, tmp_path: Path) -> None:
    process, told = kills.start(kills.SESSIONS["record"], tmp_path, 1)
    try:
        messages = [told.recv() for _ in range(12)]
        os.kill(process.pid, signal.SIGSTOP)
        for path in tmp_path.iterdir():
            os.utime(path, (1.0, 1.0))  # however long it takes, and wherever the clock is set
        growing = sorted(tmp_path.glob("*.partial*.csv"))
        offered = make(folder=tmp_path).left_over()
        assert sorted(tmp_path.glob("*.partial*.csv")) == growing
        assert not any(_is_open(left.path) for left in offered)
        os.kill(process.pid, signal.SIGCONT)
        messages += [told.recv() for _ in range(12)]
        messages += kills.kill(process, told)
    finally:
        process.kill()
    sessions.next_start(tmp_path, kills.content_of)
    assert sessions.recorded(tmp_path, messages) >= 24


def _is_open(path: Path) -> bool:
    try:
        Project.open(path).close()
    except InUseError:
        return True
    return False


def test_opening_a_file_removes_what_a_kill_was_writing_beside_it(make: Made, tmp_path: Path) -> None:
    code = "import os, sys; from pathlib import Path; from engine.formats.base.atomic import replacement; "
    code += "made = replacement(Path(sys.argv[1])); made.__enter__(); os._exit(0)"
    subprocess.run([sys.executable, "-c", code, str(tmp_path / "take.csv")], check=True)
    write_take(Take(weights=np.zeros((9, len(SHAPES))), fps=24.0), beside := tmp_path / "other.csv")
    subprocess.run([sys.executable, "-c", code, str(tmp_path / "take.csv")], check=True)
    assert len(list(tmp_path.glob(".*.part"))) == 1
    opened(make()._session, Wish(beside))
    assert not list(tmp_path.glob(".*.part"))
