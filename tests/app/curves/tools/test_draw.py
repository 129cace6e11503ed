from __future__ import annotations

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.curves.brush import eased_to
from app.curves.tools.draw import JOIN_S, DrawTool
from app.session.curve_table import CURVES
from engine.controls import ALL_INDEX
from tests.app.curves.tools.panels import FRAMES, Panel, event

LANE = ALL_INDEX["lips_vertical"]


@pytest.fixture
def tool(qtbot: QtBot) -> DrawTool:
    return DrawTool(Panel())


def drawn(tool: DrawTool) -> tuple[int, np.ndarray]:
    start, asked = tool.panel.inference.asked[-1]  # type: ignore[attr-defined]
    return start, asked[:, LANE]


def joined(tool: DrawTool, first: int, values: np.ndarray) -> tuple[int, np.ndarray]:
    ease = JOIN_S * 30
    curve = tool.panel.session.document.curve(LANE)
    span = first, first + len(values)
    return eased_to(curve, span, values, before_frames=ease, after_frames=ease)


def same(found: tuple[int, np.ndarray], wanted: tuple[int, np.ndarray]) -> bool:
    np.testing.assert_allclose(found[1], wanted[1], atol=1e-9)
    return found[0] == wanted[0]


@pytest.mark.parametrize(("to", "values"), [(34, [10, 15, 20, 25, 30]), (26, [30, 25, 20, 15, 10])])
def test_frames_that_the_pointer_jumped_over_lie_on_a_line(tool: DrawTool, to: int, values: list[float]) -> None:
    tool.press(LANE, event(300, 180))
    assert tool.busy and not tool.panel.inference.asked  # type: ignore[attr-defined]
    tool.move(LANE, event(10 * to, 140))
    assert same(drawn(tool), joined(tool, min(30, to), np.array(values, float)))
    assert tool.panel.session.view.playhead == to


def test_a_line_goes_on_from_where_the_last_one_ended_and_over_what_was_drawn(tool: DrawTool) -> None:
    tool.press(LANE, event(300, 180))
    tool.move(LANE, event(320, 140))
    tool.move(None, event(310, 100))
    assert same(drawn(tool), joined(tool, 30, np.array([10.0, 50.0, 30.0])))
    tool.release(event(310, 100))
    assert tool.panel.inference.finished == [f"draw {CURVES[LANE].title}"]  # type: ignore[attr-defined]


def test_a_sketch_ends_with_the_take_and_a_distance_at_nothing(tool: DrawTool) -> None:
    tool.press(LANE, event(580, 180))
    tool.move(LANE, event(900, 300))
    assert tool.panel.session.view.playhead == FRAMES - 1
    assert same(drawn(tool), joined(tool, 58, np.array([10.0, 0.0])))
    tool.cancel()
    tool.press(LANE, event(10, 180))
    tool.move(LANE, event(-90, 180))
    assert same(drawn(tool), joined(tool, 0, np.array([10.0, 10.0])))


def test_a_new_sketch_forgets_the_one_before(tool: DrawTool) -> None:
    for at in (10, 40):
        tool.press(LANE, event(10 * at, 180))
        tool.move(LANE, event(10 * at + 10, 180))
        tool.release(event(10 * at + 10, 180))
        assert same(drawn(tool), joined(tool, at, np.array([10.0, 10.0])))


def test_while_an_edit_is_under_way_no_pen_is_put_down(tool: DrawTool) -> None:
    tool.panel.inference.busy = True
    tool.press(LANE, event(300))
    assert not tool.busy


def test_hovering_tells_the_value_under_the_pen(tool: DrawTool) -> None:
    tool.move(LANE, event(200, 150))
    assert tool.panel.readouts == [f"{CURVES[LANE].shown(25.0)} · frame 20 · draw the curve"]  # type: ignore[attr-defined]
    tool.move(None, event(200, 150))
    assert tool.panel.readouts[-1] == "" and not tool.panel.inference.asked  # type: ignore[attr-defined]
