"""Opening a long take: the window works on, says how far it is, and shows the newest file that was asked for."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import QMimeData, QPointF, Qt, QUrl
from PySide6.QtGui import QDropEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from engine.formats import read_take, write_take
from engine.lab.performer import demo
from engine.project import Project
from engine.take import Take
from tests.journeys.conftest import load, noted, saved_as, settled


class SlowDisk:
    """Lets a file be read by the half, and no further until it is told to."""

    def __init__(self) -> None:
        self.go_on = threading.Event()
        self.ended: list[str] = []

    def __call__(self, path: Path, report: Callable[[float], None]) -> Take:
        take = read_take(path)
        try:
            report(0.5)
            while not self.go_on.wait(0.01):
                report(0.5)
            report(1.0)
        except BaseException:
            self.ended.append(path.name)
            raise
        return take


@pytest.fixture
def disk(monkeypatch: pytest.MonkeyPatch) -> Iterator[SlowDisk]:
    slow = SlowDisk()
    monkeypatch.setattr("app.session.opening.read_take", slow)
    yield slow
    slow.go_on.set()


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    one, two = tmp_path / "Ärger 顔.csv", tmp_path / "two.csv"
    for path in (one, two):
        write_take(demo.performance(), path)
    return one, two


def dropped(window: MainWindow, path: Path) -> None:
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(path))])
    action, buttons = Qt.DropAction.CopyAction, Qt.MouseButton.LeftButton
    window.dropEvent(QDropEvent(QPointF(9, 9), action, data, buttons, Qt.KeyboardModifier.NoModifier))


def reading(qtbot: QtBot, window: MainWindow, path: Path) -> None:
    qtbot.waitUntil(window.status.opening.isVisible, timeout=5_000)
    qtbot.waitUntil(lambda: window.status.opening.bar.value() == 500, timeout=5_000)
    assert window.status["saved"].text() == f"opening {path.name}…"


def test_the_open_take_is_worked_on_until_the_next_one_is_there(
    qtbot: QtBot, window: MainWindow, disk: SlowDisk, files: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(files[0]), ""))
    QTest.keyClick(window, Qt.Key.Key_O, Qt.KeyboardModifier.ControlModifier)
    reading(qtbot, window, files[0])
    session, before = window.session, window.session.view.playhead
    QTest.keyClick(window, Qt.Key.Key_Right)
    assert session.document.path == demo.BUNDLED and session.view.playhead == before + 1
    with qtbot.waitSignal(window.files.opened, timeout=10_000):
        disk.go_on.set()
    assert (
        session.document.path == files[0]
        and session.view.playhead == 0
        and window.windowTitle().startswith(files[0].name)
    )
    assert not window.status.opening.isVisible() and window.status["saved"].text() == ""


def test_reading_is_stopped_by_its_button_and_the_open_take_stays(
    qtbot: QtBot, window: MainWindow, disk: SlowDisk, files: tuple[Path, Path]
) -> None:
    take = window.session.document.take
    dropped(window, files[0])
    reading(qtbot, window, files[0])
    QTest.mouseClick(window.status.opening.button, Qt.MouseButton.LeftButton)
    assert not window.status.opening.isVisible()
    qtbot.waitUntil(lambda: disk.ended == [files[0].name], timeout=5_000)
    disk.go_on.set()
    settled(qtbot, window)
    assert window.session.document.take is take and not window.notices.isVisible()


def test_the_newest_of_two_files_is_opened(
    qtbot: QtBot, window: MainWindow, disk: SlowDisk, files: tuple[Path, Path]
) -> None:
    opened: list[Path | None] = []
    window.files.opened.connect(lambda: opened.append(window.session.document.path))
    dropped(window, files[0])
    reading(qtbot, window, files[0])
    dropped(window, files[1])
    qtbot.waitUntil(lambda: disk.ended == [files[0].name], timeout=5_000)
    reading(qtbot, window, files[1])
    disk.go_on.set()
    qtbot.waitUntil(lambda: window.session.document.path == files[1], timeout=10_000)
    assert opened == [files[1]]


def test_the_window_closes_while_a_file_is_read(
    qtbot: QtBot, window: MainWindow, disk: SlowDisk, files: tuple[Path, Path]
) -> None:
    dropped(window, files[0])
    reading(qtbot, window, files[0])
    assert window.close() and not window.isVisible()
    assert disk.ended == [files[0].name]


@pytest.fixture
def project(qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """What the window has open: the demo take with one note, saved."""
    noted(window, "one")
    saved_as(qtbot, window, tmp_path / "a.retake", monkeypatch)
    return tmp_path / "a.retake"


def test_a_project_that_is_open_can_be_opened_again_and_stays_its_file(
    qtbot: QtBot, window: MainWindow, project: Path
) -> None:
    load(qtbot, window, project)
    assert (
        window.keeper.path == project
        and not window.session.document.edited
        and len(window.session.document.marks.notes) == 1
    )
    with qtbot.waitSignal(window.keeper.kept, timeout=10_000):
        noted(window, "two")
    window.close()
    assert [note.text for note in Project.open(project).contents.marks.notes] == ["one", "two"]


def test_a_project_that_cannot_be_read_again_leaves_its_work_kept_elsewhere(
    qtbot: QtBot, window: MainWindow, project: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    release = window.keeper.release

    def damaged() -> None:
        release()
        project.write_bytes(b"something else")

    monkeypatch.setattr(window.keeper, "release", damaged)
    with qtbot.waitSignals([window.files.message, window.keeper.kept], timeout=10_000):
        window.load(project)
    assert window.session.document.edited and len(window.session.document.marks.notes) == 1
    (left,) = (tmp_path / "unsaved").glob("*.retake")
    window.session.document.undo.setClean()
    window.close()
    assert [note.text for note in Project.open(left).contents.marks.notes] == ["one"]
