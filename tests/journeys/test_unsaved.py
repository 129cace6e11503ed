"""Edits that are not saved are asked about, and work that a crash left is offered."""

from __future__ import annotations

from pathlib import Path

import pytest
from PySide6.QtWidgets import QMessageBox
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from engine.formats import write_take
from engine.lab.performer import demo
from tests.journeys.conftest import noted

Answer = QMessageBox.StandardButton


@pytest.mark.parametrize(("answer", "opens"), [(Answer.Discard, True), (Answer.Cancel, False)])
def test_opening_over_unsaved_edits_asks(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, answer: Answer, opens: bool
) -> None:
    other = tmp_path / "other.csv"
    write_take(demo.performance(), other)
    window.session.view.select((70, 90))
    window.edits.close_here()
    qtbot.waitUntil(lambda: window.session.document.undo.index() == 1, timeout=20_000)
    asked = []
    monkeypatch.setattr(QMessageBox, "question", lambda *words: asked.append(words[2]) or answer)
    edited = window.session.document.take
    window.load(other)
    assert asked == ["demo.csv has edits that are not saved."]  # before anything is read
    assert (window.files.opener.opening.path == other) is opens and window.session.document.take is edited
    if opens:
        qtbot.waitUntil(lambda: window.session.document.path == other, timeout=20_000)
        assert not window.session.document.edited and window.keeper.left_over() == []
    assert len(asked) == 1


def test_edits_that_were_given_up_are_kept_where_the_file_cannot_be_read(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken, other = tmp_path / "broken.csv", tmp_path / "other.csv"
    broken.write_text("nothing")
    write_take(demo.performance(), other)
    window.session.view.select((70, 90))
    window.edits.close_here()
    qtbot.waitUntil(lambda: window.session.document.undo.index() == 1, timeout=20_000)
    asked: list[str] = []
    monkeypatch.setattr(QMessageBox, "question", lambda *words: asked.append(words[2]) or Answer.Discard)
    window.load(broken)
    qtbot.waitUntil(window.notices.isVisible, timeout=20_000)
    assert window.session.document.edited
    qtbot.waitUntil(lambda: list((tmp_path / "unsaved").glob("*")) != [], timeout=20_000)
    window.load(other)  # they were given up for another file
    assert len(asked) == 2
    window.session.document.undo.undo()
    window.session.document.undo.redo()  # the same edits again
    qtbot.waitUntil(lambda: window.session.document.path == other, timeout=20_000)


def test_edits_made_while_a_file_is_read_are_asked_about(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = tmp_path / "other.csv"
    write_take(demo.performance(), other)
    asked: list[str] = []
    monkeypatch.setattr(QMessageBox, "question", lambda *words: asked.append(words[2]) or Answer.Cancel)
    window.load(other)
    assert asked == []
    noted(window, "wait")
    qtbot.waitUntil(lambda: bool(asked), timeout=20_000)
    assert window.session.document.path == demo.BUNDLED and len(window.session.document.marks.notes) == 1
