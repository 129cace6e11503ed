"""The animator pins a smile at a frame: it arrives and leaves, and the speech goes on."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from engine.controls import CONTROL_INDEX
from engine.take import SHAPE_INDEX
from tests.journeys.conftest import settled

SMILE, LIPS = SHAPE_INDEX["mouthSmileLeft"], CONTROL_INDEX["lips_vertical"]


def press(widget: QWidget, key: Qt.Key, times: int = 1) -> None:
    for _ in range(times):
        QTest.keyClick(widget, key)


def face_shown(window: MainWindow) -> np.ndarray:
    """The picture in the preview, (height, width, 3)."""
    image = window.preview.face.image
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : 3 * image.width()].reshape(image.height(), -1, 3).astype(float)


def test_a_pinned_smile_arrives_and_leaves_and_one_undo_takes_it_back(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    session.view.move_playhead(80)
    QTest.keyClick(window, Qt.Key.Key_P)
    settled(qtbot, window)
    assert "Move a slider" in window.pins.hint.text() and window.pins.hint.y() < window.pins.before.y()  # read first
    QTest.keyClicks(window.pins.search, "smile")
    for name in ("mouthSmileLeft", "mouthSmileRight"):
        press(window.pins.sliders[name], Qt.Key.Key_Home)
        press(window.pins.sliders[name], Qt.Key.Key_PageUp, times=14)
        qtbot.waitUntil(lambda: session.document.draft is not None, timeout=20_000)
    settled(qtbot, window)
    narrow = session.document.draft
    for box in (window.pins.before, window.pins.after):
        box.setFocus()
        box.selectAll()
        QTest.keyClicks(box, "25")
        QTest.keyClick(box, Qt.Key.Key_Tab)
    settled(qtbot, window)
    wide = session.document.draft
    assert narrow is not None and wide is not None and (wide.start, wide.stop) == (55, 106)
    assert narrow.start > 55 and narrow.stop < 106
    np.testing.assert_allclose(wide.weights[25, SMILE], narrow.weights[80 - narrow.start, SMILE])
    assert wide.weights[narrow.start - 55, SMILE] > narrow.weights[0, SMILE]

    # B held: the face as it was; let go: the pinned one again
    smiling = face_shown(window)
    QTest.keyPress(window, Qt.Key.Key_B)
    settled(qtbot, window)
    assert window.preview.face.view == "Before" and np.abs(face_shown(window) - smiling).mean() > 0.2
    QTest.keyRelease(window, Qt.Key.Key_B)
    settled(qtbot, window)
    np.testing.assert_allclose(face_shown(window), smiling, atol=3)
    QTest.mouseClick(window.pins.keep_button, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: session.document.undo.index() == 1, timeout=10_000)

    smile, before = session.document.take.weights[:, SMILE], session.document.original.weights[:, SMILE]
    assert smile[80] == 0.7
    gain = smile - before
    assert 0.1 < gain[68] < gain[80] and 0.1 < gain[92] < gain[80]
    np.testing.assert_array_equal(session.document.take.weights[:55], session.document.original.weights[:55])
    np.testing.assert_array_equal(session.document.take.weights[106:], session.document.original.weights[106:])
    speech = np.corrcoef(session.document.controls[55:106, LIPS], session.document.original_controls[55:106, LIPS])[
        0, 1
    ]
    assert speech > 0.9
    assert [pin.frame for pin in session.document.marks.pins] == [80]

    QTest.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    np.testing.assert_array_equal(session.document.take.weights, session.document.original.weights)
    assert session.document.marks.pins == ()


def test_discarding_a_pin_leaves_the_take_as_it_was(qtbot: QtBot, window: MainWindow) -> None:
    QTest.keyClick(window, Qt.Key.Key_P)
    press(next(iter(window.pins.sliders.values())), Qt.Key.Key_End)
    qtbot.waitUntil(lambda: window.session.document.draft is not None, timeout=20_000)
    QTest.mouseClick(window.pins.drop_button, Qt.MouseButton.LeftButton)
    assert window.session.document.draft is None and window.session.document.undo.count() == 0
