"""Every entry of the menus does something, and none of them breaks on a take that was only just opened."""

from __future__ import annotations

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog, QInputDialog, QMessageBox
from pytestqt.qtbot import QtBot

from app.actions.table import ACTIONS
from app.window.main_window import MainWindow
from tests.journeys.conftest import settled


@pytest.fixture
def cancelled(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever a dialog asks, the answer is Cancel."""
    for name in ("getOpenFileName", "getSaveFileName"):
        monkeypatch.setattr(QFileDialog, name, lambda *_, **__: ("", ""))
    monkeypatch.setattr(QFileDialog, "getExistingDirectory", lambda *_, **__: "")
    for name in ("getText", "getItem", "getDouble", "getInt"):
        monkeypatch.setattr(QInputDialog, name, lambda *_, **__: ("", False))
    for name in ("question", "about", "information", "exec"):
        monkeypatch.setattr(QMessageBox, name, lambda *_, **__: QMessageBox.StandardButton.Cancel)


def test_every_action_runs_on_a_fresh_take(qtbot: QtBot, window: MainWindow, cancelled: None) -> None:
    for entry in ACTIONS:
        if entry.name != "quit":
            window.actions_by_name[entry.name].trigger()  # pytest-qt fails the test for what a slot raises
            qtbot.wait(5)
    window.transport.run(0.0)
    settled(qtbot, window)


@pytest.mark.parametrize("ending", ["_tool", "view_"])
def test_what_is_chosen_stays_checked_when_it_is_chosen_again(window: MainWindow, ending: str) -> None:
    names = [entry.name for entry in ACTIONS if entry.name.endswith(ending) or entry.name.startswith(ending)]
    assert len(names) >= 4
    for name in names:
        for _ in range(2):
            window.actions_by_name[name].trigger()
            assert [each for each in names if window.actions_by_name[each].isChecked()] == [name]


def test_the_key_of_the_current_tool_leaves_its_button_checked(window: MainWindow) -> None:
    window.curves.setFocus()
    for _ in range(2):
        QTest.keyClick(window.curves, Qt.Key.Key_V)
        assert window.session.view.tool == "drag" and window.actions_by_name["drag_tool"].isChecked()


def test_ctrl_q_ends_the_program(qtbot: QtBot, window: MainWindow) -> None:
    qtbot.keyClick(window.curves, Qt.Key.Key_Q, Qt.KeyboardModifier.ControlModifier)
    qtbot.waitUntil(lambda: not window.isVisible())
