"""How believable an edit is, what is said of one that stops short, further curves, and dragging back."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from engine.controls import ALL_INDEX
from engine.regress.plausibility import DEFAULT_BELIEVABILITY
from engine.take import SHAPES
from tests.journeys.conftest import settled

LEFT, PLAIN = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
CTRL, SHIFT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier
WIDTH = ALL_INDEX["lips_horizontal"]


def pull(
    qtbot: QtBot, window: MainWindow, frame: int, by_mm: float, *, release: bool = True, lane: int = WIDTH
) -> None:
    area, shown = window.curves.viewport(), window.curves.lane(lane)
    value = float(window.session.document.controls[frame, lane])
    ends = [window.curves.mapFromScene(QPointF(shown.x_of(frame), shown.y_of(v))) for v in (value, value + by_mm)]
    QTest.mousePress(area, LEFT, PLAIN, ends[0])
    QTest.mouseMove(area, ends[1])
    qtbot.waitUntil(lambda: window.session.document.draft is not None, timeout=10_000)
    if release:
        steps = window.session.document.undo.index()
        QTest.mouseRelease(area, LEFT, PLAIN, ends[1])
        qtbot.waitUntil(lambda: window.session.document.undo.index() == steps + 1, timeout=10_000)
    settled(qtbot, window)


def test_a_session_begins_with_the_engines_default(window: MainWindow) -> None:
    assert window.session.view.believability == DEFAULT_BELIEVABILITY
    assert window.brush.believability.value() == round(100 * DEFAULT_BELIEVABILITY)
    assert not window.actions_by_name["hit_exactly"].isChecked()


def test_keys_and_slider_say_the_same(window: MainWindow) -> None:
    QTest.keyClick(window, Qt.Key.Key_E, SHIFT)
    assert window.session.view.believability == 0.0 and window.brush.believability.value() == 0
    assert window.actions_by_name["hit_exactly"].isChecked()
    window.brush.believability.setValue(80)
    assert window.session.view.believability == 0.8 and not window.actions_by_name["hit_exactly"].isChecked()


def test_a_shortfall_is_shown_with_the_button_that_reaches_it(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    window.brush.believability.setValue(100)
    session.view.choose_lane(WIDTH)
    session.view.move_playhead(150)
    window.edits.set_value(30.0)
    qtbot.waitUntil(lambda: session.document.undo.index() == 1, timeout=10_000)
    edit, title = session.document.contents().edits[-1], session.document.undo.undoText()
    assert edit.inputs["believability"] == 1.0
    assert window.facts.again_button.isHidden() and not window.facts.reach_button.isHidden()
    assert "neither this take nor the recordings go further" in window.facts.outcome.text()
    assert (
        f"{session.document.controls[150, WIDTH]:.1f} mm of {session.document.asked[150, WIDTH]:.1f} asked"
        in window.facts.outcome.text()
    )
    short = abs(session.document.asked[150, WIDTH] - session.document.controls[150, WIDTH])
    believable = session.document.take.weights.copy()

    window.facts.reach_button.click()
    qtbot.waitUntil(lambda: session.document.undo.index() == 1 and session.document.draft is None, timeout=10_000)
    settled(qtbot, window)
    assert session.document.undo.count() == 1 and session.document.undo.undoText() == title
    assert session.document.contents().edits[-1].inputs["believability"] == 0.0 and window.facts.reach_button.isHidden()
    assert abs(session.document.asked[150, WIDTH] - session.document.controls[150, WIDTH]) < 0.6 * short

    window.brush.believability.setValue(100)
    window.facts.again_button.click()
    qtbot.waitUntil(lambda: session.document.undo.index() == 1 and session.document.draft is None, timeout=10_000)
    settled(qtbot, window)
    np.testing.assert_array_equal(session.document.take.weights, believable)


def test_the_face_changes_under_the_hand_with_the_slider(qtbot: QtBot, window: MainWindow) -> None:
    window.brush.believability.setValue(100)
    pull(qtbot, window, 150, -14.0, release=False)
    draft = window.session.document.draft
    assert draft is not None
    window.brush.believability.setValue(0)
    qtbot.waitUntil(lambda: window.session.document.draft is not draft, timeout=10_000)
    assert np.abs(window.session.document.draft.weights - draft.weights).max() > 0.01
    window.edits.cancel()


def test_dragging_back_brings_back_bit_for_bit(qtbot: QtBot, window: MainWindow) -> None:
    """Two strokes are one wish of the take below; a second curve in between stays as it was asked."""
    session = window.session
    before = session.document.take.weights.copy()
    window.session.view.set_brush(radius_s=1 / 3)
    pull(qtbot, window, 150, 4.0)
    first = session.document.take.weights.copy()
    assert np.abs(first - before).max() > 0.01
    start, stop = 120, 180
    window.inference.ask(start, session.document.original_controls[start:stop].copy())
    window.inference.finish("drag back")
    qtbot.waitUntil(lambda: session.document.undo.index() == 2, timeout=10_000)
    np.testing.assert_array_equal(session.document.take.weights, before)
    session.document.undo.undo()
    np.testing.assert_array_equal(session.document.take.weights, first)


def test_a_further_curve_gets_a_lane_and_is_dragged(qtbot: QtBot, window: MainWindow) -> None:
    session, brow = window.session, ALL_INDEX["brow_inner"]
    assert brow not in session.view.lanes
    next(entry for entry in window.brush.more.menu().actions() if entry.data() == brow).trigger()
    settled(qtbot, window)
    qtbot.waitUntil(lambda: window.curves.lane(brow).scene_box().width() > 100)
    assert session.view.lane == brow
    mouth = [index for index, name in enumerate(SHAPES) if name.startswith(("mouth", "jaw"))]
    kept, value = session.document.take.weights[:, mouth].copy(), session.document.controls[150, brow]
    pull(qtbot, window, 150, 2.0, lane=brow)
    assert session.document.controls[150, brow] > value + 1.5
    np.testing.assert_array_equal(session.document.take.weights[:, mouth], kept)


def test_a_step_that_asked_for_no_curve_is_not_made_again(qtbot: QtBot, window: MainWindow) -> None:
    told: list[str] = []
    window.edits.message.connect(told.append)
    QTest.keyClick(window, Qt.Key.Key_R, CTRL)
    assert told == ["the last step set no curve"] and window.session.document.undo.count() == 0
