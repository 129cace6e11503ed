"""The drag tool alone, on a panel that notes what it is shown and asked for."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt

from app.curves.brush import pulled, reach
from app.curves.tools.drag import DragTool
from app.session.curve_table import CURVES

FRAMES, LANE = 60, 0
PLAIN, SHIFT = Qt.KeyboardModifier.NoModifier, Qt.KeyboardModifier.ShiftModifier


class Panel:
    """Ten pixels to a frame, two to a unit, upwards."""

    def __init__(self) -> None:
        self.asked: list[tuple[int, int, np.ndarray]] = []
        self.brushes: list[Any] = []
        self.readouts: list[str] = []
        self.inference = SimpleNamespace(busy=False)
        curve = np.linspace(20.0, 30.0, FRAMES)
        document = SimpleNamespace(
            take=range(FRAMES), draft=None, curve=lambda lane: curve, value=lambda lane, frame: float(curve[frame])
        )
        view = SimpleNamespace(radius_s=0.2, radius_frames=6.0, strength=1.0, playhead=None)
        view.move_playhead = lambda frame: setattr(view, "playhead", frame)
        view.set_brush = lambda *, radius_s: (
            setattr(view, "radius_s", radius_s),
            setattr(view, "radius_frames", 30 * radius_s),
        )
        self.session = SimpleNamespace(document=document, view=view)

    def frame_at(self, at: QPointF) -> float:
        return at.x() / 10

    def lane(self, lane: int) -> SimpleNamespace:
        return SimpleNamespace(value_at=lambda y: -y / 2)

    def show_brush(self, lane: object, frames: object) -> None:
        self.brushes.append(frames)

    def show_dot(self, *_: object) -> None:
        pass

    def show_readout(self, text: str, at: QPointF) -> None:
        self.readouts.append(text)


def event(x: float, y: float, keys: Qt.KeyboardModifier = PLAIN) -> SimpleNamespace:
    return SimpleNamespace(position=lambda: QPointF(x, y), modifiers=lambda: keys)


@pytest.fixture
def tool(monkeypatch: pytest.MonkeyPatch) -> DragTool:
    tool = DragTool(Panel())  # type: ignore[arg-type]
    monkeypatch.setattr(tool, "ask", lambda lane, start, curve: tool.panel.asked.append((lane, start, curve)))
    return tool


def bent(tool: DragTool, by: float, frame: int = 30) -> tuple[int, np.ndarray]:
    view, document = tool.panel.session.view, tool.panel.session.document
    start, stop = reach(frame, view.radius_frames, FRAMES)
    curve = document.curve(LANE)[start:stop]
    limits = {"floor": CURVES[LANE].lowest, "ceiling": CURVES[LANE].highest}
    return start, pulled(curve, start, frame, by=by, radius_frames=view.radius_frames, strength=view.strength, **limits)


def last(tool: DragTool) -> tuple[int, np.ndarray]:
    lane, start, curve = tool.panel.asked[-1]
    assert lane == LANE
    return start, curve


def same(found: tuple[int, np.ndarray], wanted: tuple[int, np.ndarray]) -> bool:
    np.testing.assert_allclose(found[1], wanted[1])
    return found[0] == wanted[0]


def test_a_curve_is_pulled_by_as_much_as_the_pointer_goes_up(tool: DragTool) -> None:
    tool.press(LANE, event(303, 100))
    assert tool.busy and tool.panel.session.view.playhead == 30 and not tool.panel.asked
    tool.move(None, event(303, 80))
    assert same(last(tool), bent(tool, 10.0))
    tool.move(None, event(350, 110))  # to the side nothing changes: it is held where it was taken
    assert same(last(tool), bent(tool, -5.0))
    assert "asked" in tool.panel.readouts[-1]


def test_with_shift_the_pointer_counts_a_quarter_from_where_it_is(tool: DragTool) -> None:
    tool.press(LANE, event(300, 100))
    tool.move(None, event(300, 80))
    tool.move(None, event(300, 60, SHIFT))
    assert same(last(tool), bent(tool, 10 + 2.5))
    tool.move(None, event(300, 40))
    assert same(last(tool), bent(tool, 10 + 2.5 + 10))


def test_the_wheel_widens_the_brush_by_a_share_for_each_notch_and_pulls_again(tool: DragTool) -> None:
    view = tool.panel.session.view
    tool.wheel(1.0)
    assert view.radius_s == pytest.approx(0.2 * 1.15) and not tool.panel.asked
    tool.press(LANE, event(300, 100))
    tool.wheel(2.0)
    assert not tool.panel.asked  # nothing is pulled yet
    tool.move(None, event(300, 80))
    tool.wheel(-3.0)
    assert view.radius_s == pytest.approx(0.2) and same(last(tool), bent(tool, 10.0))
    assert len(tool.panel.asked) == 2


@pytest.mark.parametrize(("x", "held"), [(-4, True), (-6, False), (594, True), (596, False)])
def test_only_frames_of_the_take_are_taken_hold_of(tool: DragTool, x: float, held: bool) -> None:
    tool.press(LANE, event(x, 100))
    assert tool.busy == held


def test_while_an_edit_is_under_way_nothing_is_taken_hold_of(tool: DragTool) -> None:
    tool.panel.inference.busy = True
    tool.press(LANE, event(300, 100))
    assert not tool.busy
    tool.panel.inference.busy, tool.panel.session.document.draft = False, object()
    tool.press(LANE, event(300, 100))
    assert not tool.busy


def test_hovering_says_what_one_could_pull_and_beside_the_lanes_nothing(tool: DragTool) -> None:
    tool.move(LANE, event(200, 100))
    assert CURVES[LANE].title in tool.panel.readouts[-1] and "frame 20" in tool.panel.readouts[-1]
    assert tool.panel.brushes[-1] == reach(20, 6.0, FRAMES)
    tool.move(None, event(200, 100))
    assert tool.panel.readouts[-1] == "" and tool.panel.brushes[-1] is None and not tool.panel.asked
