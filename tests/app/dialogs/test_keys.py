"""Keys are given by pressing them; whose a key is already is said before it is taken; the preset comes back."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from app.actions.table import ACTIONS, all_keys
from app.dialogs.keys import KeyRow, KeysDialog
from app.settings import Settings

ROWS = [KeyRow(entry.name, entry.title, entry.menu) for entry in ACTIONS]


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    return Settings(tmp_path / "settings.ini")


@pytest.fixture
def dialog(qtbot: QtBot, settings: Settings) -> Iterator[KeysDialog]:
    parent = QWidget()
    qtbot.addWidget(parent)
    made = KeysDialog(ROWS, lambda own: all_keys(settings.preset, own), settings, parent)
    made.show()
    yield made  # for as long as its parent is kept


def choose(dialog: KeysDialog, name: str) -> None:
    dialog.table.setCurrentCell([row.name for row in ROWS].index(name), 0)


def shown(dialog: KeysDialog, name: str) -> str:
    return dialog.table.item([row.name for row in ROWS].index(name), 2).text()


def test_a_free_key_is_given_at_once(qtbot: QtBot, dialog: KeysDialog, settings: Settings) -> None:
    choose(dialog, "smooth")
    with qtbot.waitSignal(dialog.changed):
        QTest.keyClick(dialog.entry, Qt.Key.Key_F7)
    assert settings.keys == {"smooth": ("F7",)} and shown(dialog, "smooth") == "F7"
    assert dialog.remark.text() == "Smooth is F7 now." and dialog.take.isHidden()


def test_a_key_of_another_action_is_taken_only_when_asked(qtbot: QtBot, dialog: KeysDialog, settings: Settings) -> None:
    choose(dialog, "smooth")
    QTest.keyClick(dialog.entry, Qt.Key.Key_V)
    assert settings.keys == {} and dialog.remark.text() == "V is used by Drag." and dialog.take.isVisible()
    with qtbot.waitSignal(dialog.changed):
        QTest.mouseClick(dialog.take, Qt.MouseButton.LeftButton)
    assert (shown(dialog, "smooth"), shown(dialog, "drag_tool")) == ("V", "")
    choose(dialog, "play")
    QTest.keyClick(dialog.entry, Qt.Key.Key_K)  # its own already
    assert shown(dialog, "play") == "K" and dialog.take.isHidden()


def test_resetting_one_leaves_what_was_given_to_another(dialog: KeysDialog, settings: Settings) -> None:
    settings.keys = {"smooth": ("V",), "drag_tool": ("F9",)}
    choose(dialog, "drag_tool")
    QTest.mouseClick(dialog.reset, Qt.MouseButton.LeftButton)
    assert shown(dialog, "drag_tool") == "" and shown(dialog, "smooth") == "V"
    QTest.mouseClick(dialog.reset_all, Qt.MouseButton.LeftButton)
    assert settings.keys == {} and (shown(dialog, "drag_tool"), shown(dialog, "smooth")) == ("V", "Ctrl+B")


def test_an_action_can_have_no_key_and_the_list_is_searched(dialog: KeysDialog, settings: Settings) -> None:
    choose(dialog, "quit")
    QTest.mouseClick(dialog.remove, Qt.MouseButton.LeftButton)
    assert settings.keys == {"quit": ()} and shown(dialog, "quit") == ""
    QTest.keyClicks(dialog.search, "undo")
    visible = [row.name for number, row in enumerate(ROWS) if not dialog.table.isRowHidden(number)]
    assert visible == ["undo"]


@pytest.mark.parametrize("stored", ["", "[]", "no json", '{"play": "K"}', '{"play": [1]}', "[" * 100_000])
def test_a_damaged_settings_file_gives_the_preset(settings: Settings, stored: str) -> None:
    settings._stored.setValue("keys", stored)
    assert settings.keys == {}
