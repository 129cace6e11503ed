"""Saving beside the work: nothing waits for the disk, and what is done meanwhile is in the file."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot

from app.session.keeper import Keeper
from app.session.opening import Wish, opened
from engine.project import Project
from tests.app.session.test_keeper import Made, alike, kept, make, push, refused, saved
from tests.performance import kills

__all__ = ["make"]  # a fixture


class SlowDisk:
    """Holds a save after its first pages until it is let go."""

    def __init__(self, keeper: Keeper, monkeypatch: pytest.MonkeyPatch) -> None:
        self.reached, self.go = threading.Event(), threading.Event()
        report = keeper._report_and_keep

        def wait(share: float) -> None:
            self.reached.set()
            self.go.wait(10.0)
            report(share)

        monkeypatch.setattr(keeper, "_report_and_keep", wait)
        monkeypatch.setattr("engine.project.store.STEP_PAGES", 1)


def test_saving_returns_at_once_and_edits_made_meanwhile_are_in_the_file(
    qtbot: QtBot, make: Made, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second, path = make(), make(), tmp_path / "a.retake"
    session = first._session
    kept(qtbot, first, lambda: push(session, 1))
    disk = SlowDisk(first, monkeypatch)
    first.save_as(path)
    assert disk.reached.wait(10.0) and first.saving == path and first.path is None
    push(session, 2)
    session.document.undo.undo()
    push(session, 3)
    copied: list[int] = []
    first.saved.connect(lambda at: copied.append(len(first._project.contents.edits)))
    with qtbot.waitSignal(first.saved, timeout=10_000):
        disk.go.set()
    assert copied == [2] and first.saving is None and first.path == path  # they came with the copy itself
    qtbot.waitUntil(lambda: not session.document.edited, timeout=10_000)
    first.close()
    second.open(opened(second._session, Wish(path)))
    assert alike(session, second._session)


def test_a_step_that_the_old_file_has_no_room_for_waits_for_the_new_one(
    qtbot: QtBot, make: Made, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second, path = make(), make(), tmp_path / "a.retake"
    kept(qtbot, first, lambda: push(first._session, 1))
    old, disk = first._project, SlowDisk(first, monkeypatch)
    first.save_as(path)
    assert disk.reached.wait(10.0)
    database = old._database
    database.execute(f"PRAGMA max_page_count = {database.execute('PRAGMA page_count').fetchone()[0]}")
    push(first._session, 2)
    disk.go.set()
    qtbot.waitUntil(lambda: first.path == path and not first._session.document.edited, timeout=10_000)
    first.close()
    second.open(opened(second._session, Wish(path)))
    assert alike(first._session, second._session)


def test_a_save_that_is_stopped_leaves_the_old_file_and_the_unsaved_work(
    qtbot: QtBot, make: Made, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, path = make(), tmp_path / "a.retake"
    kept(qtbot, first, lambda: push(first._session, 1))
    path.write_bytes(b"an older file")
    disk = SlowDisk(first, monkeypatch)
    with qtbot.waitSignal(first.failed, timeout=10_000) as told:
        first.save_as(path)
        assert disk.reached.wait(10.0)
        first.stop_saving()
        disk.go.set()
    assert told.args[0] == "The project was not saved." and first.saving is None
    assert path.read_bytes() == b"an older file" and first._session.document.edited and first.path is None
    assert [entry.name for entry in tmp_path.iterdir() if entry.is_file()] == ["a.retake"]
    kept(qtbot, first, lambda: push(first._session, 2))
    saved(qtbot, first, path)


def test_what_waits_for_a_save_happens_after_it_and_never_after_a_failure(
    qtbot: QtBot, make: Made, tmp_path: Path
) -> None:
    first = make()
    happened: list[Path | None] = []
    assert first.when_idle(lambda: happened.append(None))
    with first._lock:  # a disk that takes for ever
        first.save_as(tmp_path / "a.retake")
        assert not first.when_idle(lambda: happened.append(first.path))
    qtbot.waitUntil(lambda: len(happened) == 2, timeout=10_000)
    assert happened == [None, tmp_path / "a.retake"]
    with first._lock:
        first.save_as(tmp_path / "nowhere" / "b.retake")
        first.when_idle(lambda: happened.append(None))
    qtbot.waitUntil(lambda: first.saving is None and first._work.idle, timeout=10_000)
    qtbot.wait(20)
    assert len(happened) == 2 and first.path == tmp_path / "a.retake"


def test_a_second_save_waits_for_the_first_and_leaves_its_file(qtbot: QtBot, make: Made, tmp_path: Path) -> None:
    first, one, two = make(), tmp_path / "one.retake", tmp_path / "two.retake"
    kept(qtbot, first, lambda: push(first._session, 1))
    with first._lock:
        first.save_as(one)
        qtbot.waitUntil(lambda: not first._work._waiting, timeout=10_000)
        push(first._session, 2)
        first.save_as(two)
    qtbot.waitUntil(lambda: first.path == two and first.saving is None, timeout=10_000)
    first.close()
    assert [len(Project.open(path).contents.edits) for path in (one, two)] == [2, 2]


def test_the_project_that_is_open_can_be_opened_again(qtbot: QtBot, make: Made, tmp_path: Path) -> None:
    first, path = make(), tmp_path / "a.retake"
    push(first._session, 1)
    saved(qtbot, first, path)
    kept(qtbot, first, lambda: push(first._session, 2))
    first.release()
    first.open(opened(first._session, Wish(path)))
    assert first.path == path and first._session.document.undo.count() == 2
    kept(qtbot, first, lambda: push(first._session, 3))


def test_no_room_for_a_new_project_is_a_sentence_and_the_work_stays(
    qtbot: QtBot, make: Made, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = make()
    kept(qtbot, first, lambda: push(first._session, 1))
    assert "could not be written" in refused(qtbot, first, tmp_path / "no folder" / "a.retake")
    assert first._session.document.edited and first._session.document.undo.count() == 1
    kept(qtbot, first, lambda: push(first._session, 2))


@pytest.mark.parametrize("seed", range(6))
def test_a_kill_while_editing_and_saving_loses_no_finished_edit(seed: int, tmp_path: Path) -> None:
    kills.check(seed, tmp_path, "work")
