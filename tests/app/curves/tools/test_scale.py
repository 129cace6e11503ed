from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QPointF, QRectF, Qt
from pytestqt.qtbot import QtBot

from app.curves.brush import eased_to
from app.curves.tools.scale import HANDLE_PX, JOIN_S, ScaleTool, scaled_in_time, scaled_in_value
from app.session.curve_table import CURVES
from tests.app.curves.tools.panels import FRAMES, LANE_BOX, Panel, event

LANE = 1  # lips, side to side: far from nothing


@pytest.fixture
def tool(qtbot: QtBot) -> ScaleTool:
    tool = ScaleTool(Panel())
    tool.press(LANE, event(200))
    tool.move(LANE, event(290))
    tool.release(event(290))
    return tool


def test_amplitude_is_scaled_about_the_line_between_the_ends() -> None:
    curve = np.random.default_rng(0).random(9)
    for factor in (0.0, 0.5, 1.0, 3.0):
        found = scaled_in_value(curve, factor)
        for at, value in enumerate(curve):
            line = curve[0] + (curve[-1] - curve[0]) * at / 8
            assert found[at] == pytest.approx(line + factor * (value - line))
    np.testing.assert_allclose(scaled_in_value(curve, 1.0), curve)


def test_a_stretch_made_shorter_is_followed_by_a_line_to_what_comes_after() -> None:
    curve = np.random.default_rng(0).random(40)
    start, rows = scaled_in_time(curve, 10, 20, 16, join_frames=4.0)
    assert start == 10 and len(rows) == 10
    inside = np.interp(np.linspace(10, 19, 6), np.arange(40), curve)
    np.testing.assert_allclose(rows[:6], inside)
    np.testing.assert_allclose(rows[5:], np.linspace(inside[-1], curve[19], 5))


@pytest.mark.parametrize("new_stop", [20, 25])
def test_a_stretch_made_longer_joins_what_it_runs_into(new_stop: int) -> None:
    curve = np.random.default_rng(0).random(40)
    start, rows = scaled_in_time(curve, 10, 20, new_stop, join_frames=4.0)
    inside = np.interp(np.linspace(10, 19, new_stop - 10), np.arange(40), curve)
    wanted = eased_to(curve, (10, new_stop), inside, before_frames=0.0, after_frames=4.0)
    assert start == wanted[0] == 10
    np.testing.assert_allclose(rows, wanted[1])
    if new_stop == 20:
        np.testing.assert_allclose(rows[:10], curve[10:20])


def test_a_box_is_the_range_and_shows_its_handles(tool: ScaleTool) -> None:
    assert tool.panel.session.view.selection == (20, 30) and not tool.busy
    box, handles = tool.panel.handles[-1]  # type: ignore[attr-defined]
    assert box == QRectF(195, LANE_BOX.top() + 4, 100, LANE_BOX.height() - 8)
    assert handles == [QPointF(245, box.top()), QPointF(295, box.center().y())]
    assert not tool.panel.inference.finished  # type: ignore[attr-defined]
    tool.press(LANE, event(400))
    assert tool.panel.session.view.selection is None and tool.busy
    tool.move(LANE, event(350))
    assert tool.panel.session.view.selection == (35, 41)


@pytest.mark.parametrize(("pull", "factor"), [(25.0, 1.5), (-25.0, 0.5), (-80.0, 0.0), (0.0, 1.0)])
def test_the_top_handle_scales_the_amplitude_by_how_far_it_is_pulled(
    tool: ScaleTool, pull: float, factor: float
) -> None:
    curve = tool.panel.session.document.curve(LANE)
    tool.press(LANE, event(245, 104))
    tool.move(LANE, event(245, 104 - pull))
    ((start, asked),) = tool.panel.inference.asked  # type: ignore[attr-defined]
    assert start == 20
    np.testing.assert_allclose(asked[:, LANE], scaled_in_value(curve[20:30], factor))
    assert tool.panel.readouts[-1] == f"{CURVES[LANE].title} × {factor:.2f}"  # type: ignore[attr-defined]
    tool.release(event(245, 104 - pull))
    assert tool.panel.inference.finished == [f"scale {CURVES[LANE].title}"]  # type: ignore[attr-defined]


@pytest.mark.parametrize(("frame", "stop"), [(34, 35), (25, 26), (3, 22), (21, 22), (99, FRAMES)])
def test_the_right_handle_scales_the_time_to_the_frame_under_it(tool: ScaleTool, frame: int, stop: int) -> None:
    curve = tool.panel.session.document.curve(LANE)
    tool.press(LANE, event(295, 150))
    tool.move(LANE, event(10 * frame, 150))
    ((start, asked),) = tool.panel.inference.asked  # type: ignore[attr-defined]
    wanted = scaled_in_time(curve, 20, 30, stop, join_frames=JOIN_S * 30)
    assert start == wanted[0]
    np.testing.assert_allclose(asked[:, LANE], wanted[1])
    assert tool.panel.readouts[-1] == f"10 → {stop - 20} frames"  # type: ignore[attr-defined]
    tool.release(event(10 * frame, 150))
    assert tool.panel.inference.finished == [f"retime {CURVES[LANE].title}"]  # type: ignore[attr-defined]


@pytest.mark.parametrize(("off", "held"), [(2 * HANDLE_PX, True), (2 * HANDLE_PX + 1, False)])
def test_a_handle_is_taken_hold_of_from_near(tool: ScaleTool, off: float, held: bool) -> None:
    tool.move(LANE, event(245 + off, 104))
    assert tool.panel.readouts[-1] == ("pull to scale the amplitude" if held else "")  # type: ignore[attr-defined]
    assert tool.panel.cursors[-1] == (Qt.CursorShape.SizeVerCursor if held else tool.cursor)  # type: ignore[attr-defined]
    tool.press(LANE, event(245 + off, 104))
    assert (tool.panel.session.view.selection is not None) == held


def test_escape_drops_the_scaling_first_and_then_the_box(tool: ScaleTool) -> None:
    tool.press(LANE, event(295, 150))
    tool.move(LANE, event(340, 150))
    tool.cancel()
    assert tool.panel.inference.cancelled == 1 and not tool.busy  # type: ignore[attr-defined]
    assert tool.panel.session.view.selection == (20, 30)
    tool.cancel()
    assert tool.panel.session.view.selection is None and tool.panel.inference.cancelled == 1  # type: ignore[attr-defined]
    assert tool.panel.handles[-1] == (QRectF(), [])  # type: ignore[attr-defined]


def test_without_a_box_it_says_how_to_drag_one_and_while_an_edit_is_under_way_takes_nothing(qtbot: QtBot) -> None:
    tool = ScaleTool(Panel())
    tool.move(LANE, event(100))
    tool.move(None, event(100))
    assert tool.panel.readouts == ["drag a box over a stretch of a curve", ""]
    tool.panel.inference.busy = True
    tool.press(LANE, event(100))
    assert not tool.busy


def test_a_box_around_a_lane_that_is_not_on_screen_is_not_shown(tool: ScaleTool) -> None:
    tool._lane = len(CURVES) - 1
    tool.placed()
    assert tool.panel.handles[-1] == (QRectF(), [])  # type: ignore[attr-defined]
