"""How an edit is made, hitting its curve or believable, the rest following or kept, and made again the other way."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from engine import editing
from engine.controls import CONTROL_INDEX
from tests.journeys.conftest import settled

LEFT, PLAIN = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
CTRL, SHIFT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier
WIDTH = CONTROL_INDEX["lips_horizontal"]


def pull(qtbot: QtBot, window: MainWindow, frame: int, by_mm: float, *, release: bool = True) -> None:
    area, lane = window.curves.viewport(), window.curves.lane(WIDTH)
    value = float(window.session.controls[frame, WIDTH])
    ends = [window.curves.mapFromScene(QPointF(lane.x_of(frame), lane.y_of(v))) for v in (value, value + by_mm)]
    QTest.mousePress(area, LEFT, PLAIN, ends[0])
    QTest.mouseMove(area, ends[1])
    qtbot.waitUntil(lambda: window.session.draft is not None, timeout=10_000)
    if release:
        steps = window.session.undo.index()
        QTest.mouseRelease(area, LEFT, PLAIN, ends[1])
        qtbot.waitUntil(lambda: window.session.undo.index() == steps + 1, timeout=10_000)
    settled(qtbot, window)


def test_a_session_begins_with_the_better_default(window: MainWindow) -> None:
    assert window.session.follow == editing.FOLLOW and not window.session.exact
    assert window.actions_by_name["rest_follows"].isChecked() and window.brush.follow.isChecked()


def test_keys_and_ticks_say_the_same(window: MainWindow) -> None:
    QTest.keyClick(window, Qt.Key.Key_F, SHIFT)
    QTest.keyClick(window, Qt.Key.Key_E, SHIFT)
    assert (window.session.follow, window.session.exact) == (False, True)
    assert window.brush.exact.isChecked() and not window.brush.follow.isChecked()
    window.brush.follow.click()
    assert window.session.follow and window.actions_by_name["rest_follows"].isChecked()


def test_an_edit_remembers_how_it_was_made_and_is_made_again_otherwise(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    pull(qtbot, window, 150, 6.0)
    edit = session.contents().edits[-1]
    assert edit.inputs == {"exact": False, "follow": True}
    believable, title = session.take.weights.copy(), session.undo.undoText()
    assert window.facts.again_button.isHidden()
    assert "mm of" in window.facts.told.text() and "bit for bit" in window.facts.facts.text()

    QTest.keyClick(window, Qt.Key.Key_E, SHIFT)
    assert not window.facts.again_button.isHidden()
    QTest.keyClick(window, Qt.Key.Key_R, CTRL)
    qtbot.waitUntil(lambda: session.undo.index() == 1 and session.draft is None, timeout=10_000)
    settled(qtbot, window)
    assert session.undo.count() == 1 and session.undo.undoText() == title
    assert session.contents().edits[-1].inputs == {"exact": True, "follow": True}
    asked = session.asked[150, WIDTH]
    assert session.controls[150, WIDTH] == pytest.approx(asked, abs=0.1)

    QTest.keyClick(window, Qt.Key.Key_E, SHIFT)
    window.facts.again_button.click()
    qtbot.waitUntil(lambda: session.undo.index() == 1 and session.draft is None, timeout=10_000)
    settled(qtbot, window)
    np.testing.assert_allclose(session.take.weights, believable, rtol=0, atol=1e-6)


def test_the_face_changes_under_the_hand_when_the_way_does(qtbot: QtBot, window: MainWindow) -> None:
    pull(qtbot, window, 150, 6.0, release=False)
    draft = window.session.draft
    assert draft is not None
    QTest.keyClick(window, Qt.Key.Key_F, SHIFT)
    qtbot.waitUntil(lambda: window.session.draft is not draft, timeout=10_000)
    assert np.abs(window.session.draft.weights - draft.weights).max() > 0.01
    np.testing.assert_array_equal(window.session.draft.asked, draft.asked)
    window.edits.cancel()


def test_a_step_that_asked_for_no_curve_is_not_made_again(qtbot: QtBot, window: MainWindow) -> None:
    told: list[str] = []
    window.edits.told.connect(told.append)
    QTest.keyClick(window, Qt.Key.Key_R, CTRL)
    assert told == ["the last step asked for no curve"] and window.session.undo.count() == 0
