"""The animator pins a smile at a frame: it arrives and leaves, and the speech goes on."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.main_window import MainWindow
from engine.controls import CONTROL_INDEX
from engine.take import SHAPE_INDEX
from tests.journeys.conftest import settled

SMILE, LIPS = SHAPE_INDEX["mouthSmileLeft"], CONTROL_INDEX["lips_vertical"]


def test_a_pinned_smile_arrives_and_leaves_and_one_undo_takes_it_back(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    session.move_playhead(80)
    QTest.keyClick(window, Qt.Key.Key_K)
    QTest.keyClicks(window.pins.search, "smile")
    for name in ("mouthSmileLeft", "mouthSmileRight"):
        window.pins.sliders[name].setValue(140)
        qtbot.waitUntil(lambda: session.draft is not None, timeout=20_000)
    window.pins.before.setValue(25)
    window.pins.after.setValue(25)
    settled(qtbot, window)
    QTest.mouseClick(window.pins.keep_button, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: session.undo.index() == 1, timeout=10_000)

    smile, before = session.take.weights[:, SMILE], session.original.weights[:, SMILE]
    assert smile[80] == 0.7
    gain = smile - before
    assert 0.1 < gain[68] < gain[80] and 0.1 < gain[92] < gain[80]
    np.testing.assert_array_equal(session.take.weights[:55], session.original.weights[:55])
    np.testing.assert_array_equal(session.take.weights[106:], session.original.weights[106:])
    speech = np.corrcoef(session.controls[55:106, LIPS], session.original_controls[55:106, LIPS])[0, 1]
    assert speech > 0.9
    assert [pin.frame for pin in session.marks.pins] == [80]

    QTest.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    np.testing.assert_array_equal(session.take.weights, session.original.weights)
    assert session.marks.pins == ()


def test_dropping_a_pin_leaves_the_take_as_it_was(qtbot: QtBot, window: MainWindow) -> None:
    QTest.keyClick(window, Qt.Key.Key_K)
    next(iter(window.pins.sliders.values())).setValue(150)
    qtbot.waitUntil(lambda: window.session.draft is not None, timeout=20_000)
    QTest.mouseClick(window.pins.drop_button, Qt.MouseButton.LeftButton)
    assert window.session.draft is None and window.session.undo.count() == 0
