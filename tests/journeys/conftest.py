from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog, QMessageBox
from pytestqt.qtbot import QtBot

from app.settings import Settings
from app.window.main_window import MainWindow
from app.window.screen import DESIGNED
from engine.formats import read_take
from engine.lab.performer import demo


@pytest.fixture
def window(qtbot: QtBot, tmp_path: Path) -> Iterator[MainWindow]:
    """The window on the demo take, networks loaded and first picture drawn."""
    opened = MainWindow(
        read_take(demo.BUNDLED), demo.BUNDLED, Settings(tmp_path / "settings.ini"), unsaved=tmp_path / "unsaved"
    )
    with qtbot.waitSignal(opened.inference.ready, timeout=60_000):
        opened.show()
    opened.resize(DESIGNED)  # the offscreen screen is smaller
    settled(qtbot, opened)
    yield opened
    end(qtbot, opened)


def end(qtbot: QtBot, window: MainWindow) -> None:
    """Close a window without a question, and delete it when its threads have ended: a busy keeper delays that."""
    window.session.document.undo.setClean()
    window.close()
    qtbot.waitUntil(lambda: window.closed, timeout=30_000)
    window.deleteLater()


@pytest.fixture(autouse=True)
def no_dialog(monkeypatch: pytest.MonkeyPatch) -> None:
    """A question that no test expects would wait for ever."""

    def refuse(*words: object) -> None:
        raise AssertionError(f"an unexpected question: {words[-2:]}")

    monkeypatch.setattr(QMessageBox, "question", refuse)
    monkeypatch.setattr(QMessageBox, "exec", refuse)


def load(qtbot: QtBot, window: MainWindow, path: Path) -> None:
    """Open a file, and wait until it is open."""
    with qtbot.waitSignal(window.files.opened, timeout=20_000):
        window.load(path)


def noted(window: MainWindow, text: str) -> None:
    """Type a note on the frame at the playhead."""
    QTest.keyClicks(window.notes.entry, text)
    QTest.keyClick(window.notes.entry, Qt.Key.Key_Return)


def saved_as(qtbot: QtBot, window: MainWindow, path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Save what is open for the first time, and wait until it is saved."""
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(path), ""))
    with qtbot.waitSignal(window.keeper.saved, timeout=10_000):
        QTest.keyClick(window, Qt.Key.Key_S, Qt.KeyboardModifier.ControlModifier)


def settled(qtbot: QtBot, window: MainWindow) -> None:
    """Wait until nothing is inferred or drawn any more, full resolution included."""

    def nothing_left() -> bool:
        drawn = window.preview.drawing.idle and not window.preview._still.isActive()
        return window.inference.idle and drawn and window.flagging.idle and not window.curves.moving

    qtbot.waitUntil(nothing_left, timeout=30_000)
    qtbot.wait(20)  # results that were finished are still on their way to this thread
    qtbot.waitUntil(nothing_left, timeout=30_000)
