"""The power user: raw weights, sketching, scaling in value and time, copy and paste, Butterworth."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.session.curve_table import CURVES, FIRST_WEIGHT, weights_under
from app.window.main_window import MainWindow
from engine.controls import CONTROL_INDEX
from engine.lab.performer import demo
from engine.take import SHAPE_INDEX
from tests.journeys.conftest import load, saved_as, settled
from tests.pictures.compare import SIZE, looks_as_it_did

LEFT, PLAIN = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
LIPS, JAW = CONTROL_INDEX["lips_vertical"], FIRST_WEIGHT + SHAPE_INDEX["jawOpen"]


def at(window: MainWindow, lane: int, frame: float, value: float) -> QPoint:
    shown = window.curves.lane(lane)
    return window.curves.mapFromScene(QPointF(shown.x_of(frame), shown.y_of(value)))


def gesture(qtbot: QtBot, window: MainWindow, *points: QPoint) -> None:
    area, steps = window.curves.viewport(), window.session.document.undo.index()
    QTest.mouseMove(area, points[0])
    QTest.mousePress(area, LEFT, PLAIN, points[0])
    for point in points[1:]:
        QTest.mouseMove(area, point)
        qtbot.waitUntil(lambda: window.session.document.draft is not None, timeout=10_000)
    QTest.mouseRelease(area, LEFT, PLAIN, points[-1])
    qtbot.waitUntil(lambda: window.session.document.undo.index() == steps + 1, timeout=10_000)
    settled(qtbot, window)


def test_a_raw_weight_is_dragged_under_its_control(qtbot: QtBot, window: MainWindow) -> None:
    QTest.keyClick(window, Qt.Key.Key_W)
    assert JAW in window.session.view.lanes and set(weights_under(LIPS)) <= set(window.session.view.lanes)
    before = window.session.document.take.weights.copy()
    settled(qtbot, window)
    value = float(window.session.document.curve(JAW)[150])
    gesture(qtbot, window, at(window, JAW, 150, value), at(window, JAW, 150, value + 0.3))
    after = window.session.document.take.weights
    assert abs(after[150, SHAPE_INDEX["jawOpen"]] - (value + 0.3)) < 0.08
    others = np.arange(52) != SHAPE_INDEX["jawOpen"]
    np.testing.assert_array_equal(after[:, others], before[:, others])
    assert window.session.document.undo.undoText() == "drag jawOpen"
    QTest.keyClick(window, Qt.Key.Key_W)
    assert JAW not in window.session.view.lanes


def test_a_sketch_becomes_the_curve(qtbot: QtBot, window: MainWindow) -> None:
    QTest.keyClick(window, Qt.Key.Key_D)
    window.session.view.set_brush(believability=0.0)
    points = [at(window, LIPS, frame, value) for frame, value in ((140, 2.0), (150, 8.0), (160, 8.0), (170, 2.0))]
    gesture(qtbot, window, *points)
    reached = window.session.document.controls[:, LIPS]
    assert abs(reached[155] - 8.0) < 1.5 and reached[142] < 5.0
    assert window.session.document.undo.undoText() == "draw lips apart"


def test_a_box_is_scaled_in_value_and_in_time(qtbot: QtBot, window: MainWindow) -> None:
    QTest.keyClick(window, Qt.Key.Key_S)
    window.session.view.set_brush(believability=0.0)
    area, session = window.curves.viewport(), window.session
    QTest.mousePress(area, LEFT, PLAIN, at(window, LIPS, 70, 5.0))
    QTest.mouseMove(area, at(window, LIPS, 99, 5.0))
    QTest.mouseRelease(area, LEFT, PLAIN, at(window, LIPS, 99, 5.0))
    assert session.view.selection is not None
    start, stop = session.view.selection
    assert abs(start - 70) <= 1 and abs(stop - 100) <= 1
    peak = session.document.controls[start:stop, LIPS].max()
    box = window.curves.lane(LIPS).scene_box()
    top = window.curves.mapFromScene(QPointF(window.curves.lane(LIPS).x_of((start + stop - 1) / 2), box.top() + 4))
    gesture(qtbot, window, top, top + QPoint(0, int(box.height() / 4)))
    assert session.document.controls[start:stop, LIPS].max() < 0.75 * peak
    assert session.document.undo.undoText() == "scale lips apart"

    QTest.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    settled(qtbot, window)
    before = session.document.controls[:, LIPS].copy()
    middle = box.center().y()
    right = window.curves.mapFromScene(QPointF(window.curves.lane(LIPS).x_of(stop - 0.5), middle))
    target = window.curves.mapFromScene(QPointF(window.curves.lane(LIPS).x_of(stop - 11), middle))
    gesture(qtbot, window, right, target)
    peak_before = start + int(np.argmax(before[start:stop]))
    peak_after = start + int(np.argmax(session.document.controls[start:stop, LIPS]))
    expected = start + (peak_before - start) * (stop - 10 - start) / (stop - start)
    assert abs(peak_after - expected) <= 2
    np.testing.assert_array_equal(
        session.document.take.weights[stop + 40 :], session.document.original.weights[stop + 40 :]
    )


def test_copy_and_paste_of_a_range(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    session.view.select((40, 60))
    QTest.keyClick(window, Qt.Key.Key_C, Qt.KeyboardModifier.ControlModifier)
    session.view.move_playhead(200)
    QTest.keyClick(window, Qt.Key.Key_V, Qt.KeyboardModifier.ControlModifier)
    qtbot.waitUntil(lambda: session.document.undo.count() == 1, timeout=10_000)
    np.testing.assert_array_equal(session.document.take.weights[200:220], session.document.original.weights[40:60])
    np.testing.assert_array_equal(session.document.take.weights[224:], session.document.original.weights[224:])


def test_smoothing_is_previewed_then_kept_or_discarded(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    QTest.keyClick(window, Qt.Key.Key_S)
    session.view.select((50, 150))
    window.smoothing.cutoff.setValue(2.0)
    qtbot.waitUntil(lambda: session.document.draft is not None, timeout=10_000)
    np.testing.assert_array_equal(session.document.take.weights, session.document.original.weights)
    QTest.mouseClick(window.smoothing.drop_button, LEFT)
    assert session.document.draft is None and session.document.undo.count() == 0
    window.smoothing.cutoff.setValue(3.0)
    QTest.mouseClick(window.smoothing.keep_button, LEFT)
    qtbot.waitUntil(lambda: session.document.undo.count() == 1, timeout=10_000)
    rough = np.abs(np.diff(session.document.original.weights[60:140], n=2, axis=0)).sum()
    assert np.abs(np.diff(session.document.take.weights[60:140], n=2, axis=0)).sum() < 0.6 * rough
    outside = np.r_[0:50, 150 : len(session.document.take)]
    np.testing.assert_array_equal(session.document.take.weights[outside], session.document.original.weights[outside])


def test_a_typed_value_is_reached(qtbot: QtBot, window: MainWindow) -> None:
    window.session.view.move_playhead(160)
    window.session.view.set_brush(believability=0.0)
    window.value.value.setFocus()
    window.value.value.selectAll()
    QTest.keyClicks(window.value.value, "7.5")
    QTest.keyClick(window.value.value, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: window.session.document.undo.count() == 1, timeout=10_000)
    assert abs(window.session.document.controls[160, LIPS] - 7.5) < 0.1
    assert CURVES[LIPS].title in window.session.document.undo.undoText()


def reopened(qtbot: QtBot, window: MainWindow, path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Save the project, open something else, and open it again."""
    saved_as(qtbot, window, path, monkeypatch)
    for opened in (demo.BUNDLED, path):
        load(qtbot, window, opened)


def test_a_morning_of_editing_is_kept_step_by_step(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Box-select, scale in time, draw, paste, Butterworth and a raw weight, one after another by mouse and keys."""
    session, area, control = window.session, window.curves.viewport(), Qt.KeyboardModifier.ControlModifier
    window.resize(*SIZE)
    states = [session.document.take.weights]

    def done(step: str) -> None:
        qtbot.waitUntil(lambda: session.document.undo.index() == len(states), timeout=10_000)
        settled(qtbot, window)
        assert session.document.undo.undoText() == step and (session.document.take.weights != states[-1]).any()
        states.append(session.document.take.weights)

    QTest.keyClick(window, Qt.Key.Key_S)
    settled(qtbot, window)
    QTest.mousePress(area, LEFT, PLAIN, at(window, LIPS, 70, 5.0))
    QTest.mouseMove(area, at(window, LIPS, 99, 5.0))
    QTest.mouseRelease(area, LEFT, PLAIN, at(window, LIPS, 99, 5.0))
    start, stop = session.view.selection or (0, 0)
    middle = window.curves.lane(LIPS).scene_box().center().y()
    ends = [
        window.curves.mapFromScene(QPointF(window.curves.lane(LIPS).x_of(x), middle)) for x in (stop - 0.5, stop - 9)
    ]
    gesture(qtbot, window, *ends)
    done("retime lips apart")

    QTest.keyClick(window, Qt.Key.Key_Escape)
    QTest.keyClick(window, Qt.Key.Key_D)
    gesture(qtbot, window, *(at(window, LIPS, f, v) for f, v in ((140, 3.0), (150, 9.0), (160, 9.0), (170, 3.0))))
    done("draw lips apart")

    session.view.select((start, stop))
    QTest.keyClick(window, Qt.Key.Key_C, control)
    QTest.keyClick(window, Qt.Key.Key_D, control)
    session.view.move_playhead(200)
    QTest.keyClick(window, Qt.Key.Key_V, control)
    done(f"paste {stop - start} frames")

    session.view.move_playhead(20)
    QTest.keyClick(window, Qt.Key.Key_I)
    session.view.move_playhead(60)
    QTest.keyClick(window, Qt.Key.Key_O)
    assert session.view.selection == (20, 61)
    QTest.keyClick(window, Qt.Key.Key_B, control)
    done("smooth at 6 Hz")

    QTest.keyClick(window, Qt.Key.Key_D, control)
    QTest.keyClick(window, Qt.Key.Key_V)
    QTest.keyClick(window, Qt.Key.Key_W)
    settled(qtbot, window)
    value = float(session.document.curve(JAW)[150])
    gesture(qtbot, window, at(window, JAW, 150, value), at(window, JAW, 150, value + 0.2))
    done("drag jawOpen")

    settled(qtbot, window)
    assert looks_as_it_did(window, "journey_power_user", tmp_path)
    reopened(qtbot, window, tmp_path / "morning.retake", monkeypatch)
    for weights in reversed(states):
        np.testing.assert_array_equal(session.document.take.weights, weights)
        QTest.keyClick(window, Qt.Key.Key_Z, control)
