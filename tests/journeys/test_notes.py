"""The reviewer leaves a note on a frame and finds it again."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from engine.lab.performer import demo
from tests.journeys.conftest import load, noted


def test_a_note_is_typed_shown_saved_and_taken_back(qtbot: QtBot, window: MainWindow, tmp_path: Path) -> None:
    session, height = window.session, window.timeline.sizeHint().height()
    session.view.move_playhead(120)
    QTest.keyClick(window, Qt.Key.Key_N)
    noted(window, "lips miss the b")
    (note,) = session.document.marks.notes
    assert (note.frame, note.text) == (120, "lips miss the b")
    assert window.timeline.sizeHint().height() > height
    with qtbot.waitSignal(window.keeper.saved, timeout=10_000):
        window.keeper.save_as(tmp_path / "noted.retake")
    load(qtbot, window, demo.BUNDLED)
    assert session.document.marks.notes == ()
    load(qtbot, window, tmp_path / "noted.retake")
    assert session.document.marks.notes == (note,)
    session.document.undo.undo()
    assert session.document.marks.notes == ()
