"""Edits that are not saved are asked about, and work that a crash left is offered."""

from __future__ import annotations

from pathlib import Path

import pytest
from PySide6.QtWidgets import QMessageBox
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from engine.formats import write_take
from engine.performance import demo

Answer = QMessageBox.StandardButton


@pytest.mark.parametrize(("answer", "opens"), [(Answer.Discard, True), (Answer.Cancel, False)])
def test_opening_over_unsaved_edits_asks(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, answer: Answer, opens: bool
) -> None:
    other = tmp_path / "other.csv"
    write_take(demo.performance(), other)
    window.session.select((70, 90))
    window.edits.close_here()
    qtbot.waitUntil(lambda: window.session.undo.index() == 1, timeout=20_000)
    asked = []
    monkeypatch.setattr(QMessageBox, "question", lambda *words: asked.append(words[2]) or answer)
    edited = window.session.take
    window.load(other)
    qtbot.waitUntil(lambda: bool(asked), timeout=20_000)
    assert asked == ["demo.csv has edits that are not saved."]
    assert (window.session.take is edited) is not opens
