"""The lanes keep their places: whatever is done in whatever order, each is as wide as the panel and under its frames."""

from __future__ import annotations

import random

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QSplitter
from pytestqt.qtbot import QtBot

from app.curves.places import GUTTER_PX
from app.session.curve_table import FIRST_WEIGHT, weights_under
from app.theme import GRID
from app.window.main_window import MainWindow
from engine.controls import CONTROLS
from tests.journeys.conftest import settled

LEFT, PLAIN = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
EYES = [index for index, control in enumerate(CONTROLS) if control.area == "eyelids"]
STEPS = 60


def name_of(window: MainWindow, lane: int) -> QPoint:
    box = window.curves.lane(lane).scene_box()
    return window.curves.mapFromScene(QPointF(20, box.center().y()))


def assert_lanes_keep_their_places(window: MainWindow) -> None:
    curves, session = window.curves, window.session
    assert [lane.key for lane in curves.lanes] == session.view.lanes
    width, below = curves.width() - GUTTER_PX - GRID, -1.0
    for lane in curves.lanes:
        box = lane.view.geometry()
        assert box == lane.scene_box() and lane.view.isVisible() and lane.gutter.isVisible()
        assert (box.left(), box.width()) == (GUTTER_PX, width) and box.height() > 10
        assert box.top() > below and box.bottom() <= curves.height()
        below = box.bottom()
        edges = [lane.view.mapViewToScene(QPointF(frame, 0.0)).x() for frame in session.view.range]
        np.testing.assert_allclose(edges, [box.left(), box.right()], atol=1.5)
        drawn = lane.reached.boundingRect()
        assert drawn.left() <= session.view.range[0] + 1 and drawn.right() >= session.view.range[1] - 1
    hidden = set(curves.stack.known) - set(session.view.lanes)
    assert not any(curves.stack.known[key].view.isVisible() for key in hidden)


def do_something(window: MainWindow, rng: random.Random) -> None:
    session, split = window.session, window.preview.parentWidget()
    assert isinstance(split, QSplitter)
    first = rng.uniform(0, len(session.document.take))
    rng.choice(
        (
            lambda: session.view.expand(rng.randrange(FIRST_WEIGHT)),
            lambda: QTest.mouseClick(
                window.curves.viewport(), LEFT, PLAIN, name_of(window, rng.choice(session.view.lanes))
            ),
            lambda: session.view.zoom(rng.choice([0.4, 0.7, 1.5, 4.0]), rng.uniform(*session.view.range)),
            lambda: session.view.set_range(first, first + rng.uniform(8, 200)),
            lambda: split.setSizes([rng.randint(200, 900), rng.randint(200, 900)]),
            window.actions_by_name["light_theme"].trigger,
            lambda: QApplication.sendEvent(window.curves, QEvent(QEvent.Type.DevicePixelRatioChange)),
            lambda: window.resize(rng.randint(1050, 1900), rng.randint(500, 1200)),
            lambda: session.view.choose_lane(rng.choice(session.view.lanes)),
            lambda: session.view.choose_tool(rng.choice(["drag", "clean", "pin", "retarget"])),
            lambda: window.inspector.setVisible(not window.inspector.isVisible()),
        )
    )()


@pytest.mark.parametrize("seed", range(2))
def test_lanes_keep_their_width_whatever_is_done_in_whatever_order(qtbot: QtBot, window: MainWindow, seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(STEPS):
        do_something(window, rng)
        QApplication.processEvents()
        qtbot.waitUntil(lambda: not window.curves.moving, timeout=5_000)
        assert_lanes_keep_their_places(window)
    settled(qtbot, window)
    assert_lanes_keep_their_places(window)


@pytest.mark.parametrize("eye", EYES)
def test_an_expanded_eye_keeps_its_curves(qtbot: QtBot, window: MainWindow, eye: int) -> None:
    QTest.mouseClick(window.curves.viewport(), LEFT, PLAIN, name_of(window, eye))
    assert set(weights_under(eye)) <= set(window.session.view.lanes)
    settled(qtbot, window)
    assert_lanes_keep_their_places(window)
    QTest.keyClick(window, Qt.Key.Key_W)
    settled(qtbot, window)
    assert_lanes_keep_their_places(window)


def test_nothing_moves_under_the_pointer_while_a_button_is_down(qtbot: QtBot, window: MainWindow) -> None:
    curves = window.curves
    other = window.session.view.lanes[3]
    before = [lane.scene_box() for lane in curves.lanes]
    at = curves.mapFromScene(before[3].center())
    QTest.mousePress(curves.viewport(), LEFT, PLAIN, at)
    assert window.session.view.lane == other
    qtbot.wait(250)
    assert [lane.scene_box() for lane in curves.lanes] == before
    QTest.mouseRelease(curves.viewport(), LEFT, PLAIN, at)
    assert [lane.scene_box() for lane in curves.lanes] == before  # and it does not leap when it is let go
    qtbot.waitUntil(lambda: curves.lane(other).scene_box().height() > 1.5 * before[3].height(), timeout=10_000)


def test_lines_are_as_wide_on_a_finer_screen(window: MainWindow, monkeypatch: pytest.MonkeyPatch) -> None:
    lane = window.curves.lanes[0]
    assert lane.reached._pen.widthF() == window.curves.devicePixelRatioF()
    monkeypatch.setattr(type(window.curves), "devicePixelRatioF", lambda _: 2.0)
    QApplication.sendEvent(window.curves, QEvent(QEvent.Type.DevicePixelRatioChange))
    lines = (lane.original._pen, lane.reached._pen, lane.asked._pen, lane.removed.line.opts["pen"])
    assert {pen.widthF() for pen in lines} == {2.0}
    window.session.view.expand(0)  # and so are those that come later
    assert {each.reached._pen.widthF() for each in window.curves.lanes} == {2.0}


def test_hidden_weights_are_up_to_date_when_shown_again(qtbot: QtBot, window: MainWindow) -> None:
    session, key = window.session, weights_under(EYES[0])[0]
    session.view.expand(EYES[0])
    column = key - FIRST_WEIGHT
    session.view.expand(EYES[0])
    for start in (40, 200):
        weights = session.document.take.weights[start : start + 8].copy()
        weights[:, column] = 0.77
        controls, asked = session.document.controls[start : start + 8], session.document.asked[start : start + 8]
        lost = session.document.take.lost[start : start + len(weights)]
        session.document.replace_rows(start, weights, controls, asked, lost)
    session.view.expand(EYES[0])
    lowest, highest = window.curves.lane(key)._curves[1]._kept()
    blocks = session.document.curve(key)[:320].reshape(-1, 8)
    np.testing.assert_array_equal(highest[:40], blocks.max(axis=1))
    np.testing.assert_array_equal(lowest[:40], blocks.min(axis=1))
