"""Saving a long take: the window works on, says how far it is, and closes when all is safe."""

from __future__ import annotations

from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog, QMessageBox
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from engine.project import Project
from tests.journeys.conftest import noted, settled

Answer = QMessageBox.StandardButton


def test_closing_while_a_project_is_saved_waits_with_a_sentence(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "Ärger 顔.retake"
    noted(window, "one")
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(path), ""))
    with window.keeper._lock:  # a disk that takes for ever
        QTest.keyClick(window, Qt.Key.Key_S, Qt.KeyboardModifier.ControlModifier)
        qtbot.waitUntil(window.status.saving.isVisible, timeout=5_000)
        assert window.status["saved"].text() == "saving Ärger 顔.retake…"
        noted(window, "two")
        assert not window.close() and window.isVisible()
        assert window.notices.text.text().startswith("demo.csv is being saved; then it is closed.")
    qtbot.waitUntil(lambda: not window.isVisible(), timeout=10_000)
    assert [note.text for note in Project.open(path).contents.marks.notes] == ["one", "two"]


@pytest.mark.parametrize("room", [True, False])
def test_answering_save_closes_when_it_is_saved_and_stays_open_when_it_cannot_be(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, room: bool
) -> None:
    path = tmp_path / "a.retake" if room else tmp_path / "no folder" / "a.retake"
    noted(window, "one")
    qtbot.waitUntil(lambda: window.keeper._work.idle, timeout=10_000)
    monkeypatch.setattr(QMessageBox, "question", lambda *_: Answer.Save)
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(path), ""))
    window.close()
    if room:
        qtbot.waitUntil(lambda: not window.isVisible(), timeout=10_000)
        assert len(Project.open(path).contents.marks.notes) == 1
    else:
        qtbot.waitUntil(lambda: "could not be written" in window.notices.text.text(), timeout=10_000)
        settled(qtbot, window)
        assert window.isVisible() and window.session.document.edited and len(window.session.document.marks.notes) == 1
