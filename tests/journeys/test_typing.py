"""Whatever is typed into a number box stays there: no key of it is a shortcut meanwhile, under any program's keys."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractSpinBox

from app.settings import PRESETS
from app.window.main_window import MainWindow

LEFT, PLAIN, Key = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, Qt.Key


@pytest.fixture(params=list(PRESETS))
def done(request: pytest.FixtureRequest, window: MainWindow) -> list[str]:
    """The actions that were carried out since the window opened with a program's keys."""
    window.menus.use_preset(request.param)
    window.session.view.move_playhead(120)
    names: list[str] = []
    for name, action in window.actions_by_name.items():
        action.triggered.connect(lambda _=False, name=name: names.append(name))
    return names


def press(box: QAbstractSpinBox, *keys: Qt.Key) -> None:
    for key in keys:
        QTest.keyClick(box, key)


def click_into(box: QAbstractSpinBox) -> None:
    QTest.mouseClick(box, LEFT, PLAIN, QPoint(10, box.height() // 2))
    assert box.hasFocus()


def test_a_whole_number_is_stepped_and_typed(window: MainWindow, done: list[str]) -> None:
    window.session.view.choose_tool("pin")
    box = window.pins.before
    click_into(box)
    before = box.value()
    press(box, Key.Key_Up)
    assert box.value() == before + 1
    press(box, Key.Key_Down, Key.Key_Down)
    assert box.value() == before - 1
    press(box, Key.Key_PageUp)
    assert box.value() == before + 9
    press(box, Key.Key_PageDown)
    assert box.value() == before - 1
    press(box, Key.Key_Home, Key.Key_Delete)  # the first digit goes
    QTest.keyClicks(box, "4")
    press(box, Key.Key_Right, Key.Key_Left, Key.Key_Return)
    assert box.value() == int("4" + str(before - 1)[1:])
    assert done == [] and window.session.view.playhead == 120


def test_a_number_with_decimals_is_typed(window: MainWindow, done: list[str]) -> None:
    box = window.value.value
    click_into(box)
    box.selectAll()
    QTest.keyClicks(box, "7.5")
    assert box.text().startswith("7.5")
    press(box, Key.Key_Left, Key.Key_Backspace, Key.Key_End)
    assert box.text().startswith("75")
    assert done == [] and window.session.view.playhead == 120


def test_away_from_the_box_the_keys_are_the_window_s(window: MainWindow, done: list[str]) -> None:
    click_into(window.brush.radius)
    before = window.brush.radius.value()
    window.curves.setFocus()
    QTest.keyClick(window.curves, Key.Key_Down)
    assert done == ["next_span"] and window.brush.radius.value() == before
