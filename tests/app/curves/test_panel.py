"""The panel of curves under real mouse and wheel events, with tools that note what comes to them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, QRectF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QScrollArea
from pytestqt.qtbot import QtBot

from app.curves.panel import EXPANDER, MIN_LANE_PX, WHEEL_STEP, CurvesPanel
from app.curves.places import GUTTER_PX
from app.session import Session
from app.theme import DARK
from engine.take import SHAPES, Take
from tests.app.curves.tools.panels import Inference

LEFT, MIDDLE, PLAIN = Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton, Qt.KeyboardModifier.NoModifier


@pytest.fixture
def panel(qtbot: QtBot) -> Iterator[CurvesPanel]:
    weights = np.random.default_rng(0).random((400, len(SHAPES)))
    shown = CurvesPanel(Session(Take(weights, 30.0)), Inference(), DARK)  # type: ignore[arg-type]
    host = QScrollArea()  # as in the window; a view of pyqtgraph that is closed by itself takes its scene with it
    qtbot.addWidget(host)
    host.setWidget(shown)
    shown.resize(GUTTER_PX + 500, 640)
    host.resize(GUTTER_PX + 540, 680)
    shown.session.view.set_range(100, 200)
    with qtbot.waitExposed(host):
        host.show()
    qtbot.waitUntil(lambda: not shown.moving, timeout=30_000)
    yield shown


def at(panel: CurvesPanel, row: int, frame: float = 150) -> QPoint:
    box = panel.lanes[row].scene_box()
    return panel.mapFromScene(QPointF(panel.stack.x_of(frame, panel.session.view.range), box.center().y()))


def in_gutter(panel: CurvesPanel, row: int, share: float) -> QPoint:
    return panel.mapFromScene(QPointF(GUTTER_PX * share, panel.lanes[row].scene_box().center().y()))


def turned(panel: CurvesPanel, place: QPoint, turn: QPoint, keys: Qt.KeyboardModifier = PLAIN) -> bool:
    wheel = QWheelEvent(
        QPointF(place), QPointF(panel.mapToGlobal(place)), QPoint(), turn, Qt.MouseButton.NoButton, keys,
        Qt.ScrollPhase.NoScrollPhase, False,
    )  # fmt: skip
    QApplication.sendEvent(panel.viewport(), wheel)
    return wheel.isAccepted()


def noted(panel: CurvesPanel, monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, Any]]:
    calls: list[tuple[str, Any]] = []
    monkeypatch.setattr(panel.tool, "press", lambda lane, event: calls.append(("press", lane)))
    monkeypatch.setattr(panel.tool, "move", lambda lane, event: calls.append(("move", lane)))
    monkeypatch.setattr(panel.tool, "release", lambda event: calls.append(("release", None)))
    monkeypatch.setattr(panel.tool, "wheel", lambda notches: calls.append(("wheel", notches)))
    return calls


def test_a_press_goes_to_the_tool_with_the_lane_under_it(panel: CurvesPanel, monkeypatch: pytest.MonkeyPatch) -> None:
    calls = noted(panel, monkeypatch)
    QTest.mousePress(panel.viewport(), LEFT, PLAIN, at(panel, 3))
    assert panel.session.view.lane == panel.lanes[3].key
    QTest.mouseRelease(panel.viewport(), LEFT, PLAIN, at(panel, 3))
    assert [name for name, _ in calls if name != "move"] == ["press", "release"]
    assert ("press", panel.lanes[3].key) in calls
    assert panel.frame_at(QPointF(at(panel, 3))) == pytest.approx(150, abs=0.2)


def test_lanes_stay_under_the_pointer_until_the_button_is_let_go(
    qtbot: QtBot, panel: CurvesPanel, monkeypatch: pytest.MonkeyPatch
) -> None:
    noted(panel, monkeypatch)
    before = [lane.scene_box() for lane in panel.lanes]
    place = at(panel, 4)
    QTest.mousePress(panel.viewport(), LEFT, PLAIN, place)
    assert not panel.moving and [lane.scene_box() for lane in panel.lanes] == before
    QTest.mouseRelease(panel.viewport(), LEFT, PLAIN, place)
    qtbot.waitUntil(
        lambda: not panel.moving and panel.lanes[4].scene_box().height() > 1.5 * before[4].height(), timeout=30_000
    )


@pytest.mark.parametrize(("share", "opens"), [(EXPANDER - 0.05, True), (EXPANDER + 0.05, False)])
def test_a_click_on_a_name_opens_the_weights_below_it(panel: CurvesPanel, share: float, opens: bool) -> None:
    key, count = panel.lanes[2].key, len(panel.lanes)
    QTest.mouseClick(panel.viewport(), LEFT, PLAIN, in_gutter(panel, 2, share))
    assert (key in panel.session.view.expanded) == opens == (len(panel.lanes) > count)
    assert panel.session.view.lane == key and panel.minimumHeight() == MIN_LANE_PX * len(panel.lanes)


def test_a_name_that_is_let_go_elsewhere_is_not_clicked(panel: CurvesPanel) -> None:
    QTest.mousePress(panel.viewport(), LEFT, PLAIN, in_gutter(panel, 2, 0.5))
    QTest.mouseRelease(panel.viewport(), LEFT, PLAIN, in_gutter(panel, 4, 0.5))
    assert not panel.session.view.expanded


def test_the_middle_button_pans_by_as_much_as_it_goes(panel: CurvesPanel) -> None:
    QTest.mousePress(panel.viewport(), MIDDLE, PLAIN, at(panel, 3))
    QTest.mouseMove(panel.viewport(), at(panel, 3) + QPoint(-50, 0))
    first, last = panel.session.view.range
    assert first == pytest.approx(100 + 50 / panel.stack.box().width() * 100) and last - first == pytest.approx(100)
    QTest.mouseRelease(panel.viewport(), MIDDLE, PLAIN, at(panel, 3))
    QTest.mouseMove(panel.viewport(), at(panel, 3) + QPoint(40, 0))
    assert panel.session.view.range == (first, last)


def test_the_wheel_pans_zooms_changes_the_tool_or_is_left_to_the_scroll_area(
    panel: CurvesPanel, monkeypatch: pytest.MonkeyPatch
) -> None:
    view, calls, place = panel.session.view, noted(panel, monkeypatch), at(panel, 3, 120)
    assert not turned(panel, place, QPoint(0, 120)) and view.range == (100, 200)
    assert turned(panel, place, QPoint(0, 120), Qt.KeyboardModifier.ShiftModifier) and view.range == (90, 190)
    assert turned(panel, place, QPoint(-240, 0)) and view.range == (110, 210)
    view.set_range(100, 200)
    under = panel.frame_at(QPointF(place))
    assert turned(panel, place, QPoint(0, 120), Qt.KeyboardModifier.ControlModifier)
    assert view.range[1] - view.range[0] == pytest.approx(100 / WHEEL_STEP)
    assert panel.frame_at(QPointF(place)) == pytest.approx(under, abs=1e-6)
    assert turned(panel, place, QPoint(0, -240), Qt.KeyboardModifier.AltModifier)
    assert calls == [("wheel", -2.0)]


def test_another_tool_ends_the_gesture_of_the_one_before(panel: CurvesPanel, monkeypatch: pytest.MonkeyPatch) -> None:
    ended: list[str] = []
    for name in panel.tools:
        monkeypatch.setattr(type(panel.tools[name]), "busy", property(lambda tool: tool in held))
        monkeypatch.setattr(panel.tools[name], "cancel", lambda name=name: ended.append(name))
    held = [panel.tools["draw"]]
    panel.session.view.choose_tool("scale")
    assert ended == ["draw"] and panel.cursor().shape() == panel.tools["scale"].cursor
    held[:] = [panel.tools["scale"]]
    panel.session.view.choose_tool("scale")
    panel.session.view.choose_tool("draw")
    assert ended == ["draw", "scale"]
    held[:] = [panel.tools["draw"]]
    panel.session.open(Take(np.zeros((90, len(SHAPES))), 30.0), None)
    assert ended[2:] == ["draw"]


def test_a_read_out_stays_inside_the_panel(panel: CurvesPanel) -> None:
    panel.show_readout("12.0 mm", QPointF(300, 200))
    assert panel.readout.isVisible() and panel.readout.text() == "12.0 mm"
    assert panel.readout.pos() == QPoint(314, 200 - panel.readout.height() - 8)
    panel.show_readout("12.0 mm", QPointF(panel.width(), 0))
    assert panel.rect().contains(panel.readout.geometry())
    panel.show_readout("", QPointF(300, 200))
    assert not panel.readout.isVisible()


def test_the_gutter_tells_each_value_at_the_playhead(panel: CurvesPanel) -> None:
    panel.session.view.move_playhead(123)
    for lane in panel.lanes:
        assert lane.gutter.value == panel.session.document.value(lane.key, 123)
    panel.show_dot(panel.lanes[2], 123, 4.0)
    assert [lane.dot.isVisible() for lane in panel.lanes] == [row == 2 for row in range(len(panel.lanes))]
    panel.show_dot(None)
    assert not any(lane.dot.isVisible() for lane in panel.lanes)


def test_handles_are_put_away_with_the_tool(panel: CurvesPanel) -> None:
    panel.show_handles(QRectF(200, 10, 50, 50), [QPointF(200, 10)])
    panel.session.view.choose_tool("draw")
    assert panel._playhead.box.isNull() and panel._playhead.handles == []
