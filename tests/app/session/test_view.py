"""Where one looks, and with what one works, without a window."""

from __future__ import annotations

import numpy as np
import pytest

from app.session import RADII_S, Change, Document, View
from app.session.curve_table import FIRST_WEIGHT, weights_under
from app.session.view import BRUSH_S, FIRST_VIEW_S
from engine.character import bundled
from engine.controls import CONTROLS
from engine.take import SHAPES, Take

FRAMES, FPS = 1000, 30.0


@pytest.fixture
def view() -> View:
    return View(Document(Take(np.zeros((FRAMES, len(SHAPES))), FPS)))


@pytest.fixture
def signalled(view: View) -> list[Change]:
    seen: list[Change] = []
    view.changed.connect(seen.append)
    return seen


def test_one_begins_at_the_first_frame_with_sixteen_seconds_on_screen(view: View) -> None:
    assert (view.playhead, view.selection, view.lane, view.tool) == (0, None, 0, "drag")
    assert view.range == (0.0, FIRST_VIEW_S * FPS) and view.lanes == list(range(len(CONTROLS)))


@pytest.mark.parametrize(("wanted", "got"), [(-5, 0), (0, 0), (999, 999), (4000, 999)])
def test_the_playhead_stays_on_frames_that_exist(view: View, wanted: int, got: int) -> None:
    view.move_playhead(wanted)
    assert view.playhead == got


def test_the_frames_on_screen_follow_the_playhead_and_keep_their_number(view: View, signalled: list[Change]) -> None:
    view.move_playhead(480)
    assert signalled == [Change.PLAYHEAD] and view.range == (0.0, 480.0)
    view.move_playhead(481)
    assert signalled[1:] == [Change.PLAYHEAD, Change.VIEW] and view.range == (481 - 48, 481 + 432)
    view.move_playhead(481)
    assert len(signalled) == 3
    view.move_playhead(100)
    assert view.range == (0.0, 480.0)  # 100 would be nine tenths across, and nothing lies before the first frame


@pytest.mark.parametrize(
    ("wanted", "got"),
    [
        ((10, 20), (10, 20)),
        ((10, 12), (10, 18)),
        ((-50, 50), (0, 100)),
        ((990, 1090), (899, 999)),
        ((0, 1e9), (0, 999)),
    ],
)
def test_at_least_eight_frames_and_no_more_than_there_are_on_screen(
    view: View, wanted: tuple[float, float], got: tuple[float, float]
) -> None:
    view.set_range(*wanted)
    assert view.range == got


def test_zooming_keeps_a_frame_in_its_place(view: View) -> None:
    view.set_range(100, 300)
    view.zoom(2.0, 150)
    assert view.range == (125.0, 225.0)
    view.zoom(0.5, 150)
    assert view.range == (100.0, 300.0)


@pytest.mark.parametrize(
    ("wanted", "got"),
    [((5, 9), (5, 9)), ((9, 5), (5, 9)), ((7, 7), None), ((-3, 4), (0, 4)), ((990, 2000), (990, 1000))],
)
def test_a_selection_is_a_range_of_frames_or_nothing(
    view: View, wanted: tuple[int, int], got: tuple[int, int] | None
) -> None:
    view.select((1, 2))
    view.select(wanted)
    assert view.selection == got


def test_weights_stand_below_the_control_that_is_expanded(view: View, signalled: list[Change]) -> None:
    under = weights_under(1)
    view.expand(1)
    assert signalled == [Change.LANES | Change.LANE]
    assert view.lanes == [0, 1, *under, *range(2, len(CONTROLS))]
    view.choose_lane(under[0])
    view.expand(under[0])  # named by one of them
    assert view.lanes == list(range(len(CONTROLS))) and view.lane == 1


def test_a_control_beyond_the_eight_gets_a_lane_and_loses_it(view: View) -> None:
    extra = len(CONTROLS)
    assert extra < FIRST_WEIGHT
    view.add_lane(extra)
    assert view.lanes == list(range(extra + 1)) and view.lane == extra
    view.add_lane(extra, shown=False)
    assert view.lanes == list(range(extra)) and view.lane == 0
    view.add_lane(2)  # it has one
    assert view.lane == 0


def test_the_brush_stays_within_its_limits_and_comes_to_frames(view: View, signalled: list[Change]) -> None:
    view.set_brush(radius_s=0.5, strength=3.0, believability=-1.0)
    assert (view.radius_frames, view.strength, view.believability) == (15.0, 1.0, 0.0) and signalled == [Change.TOOL]
    for asked, got in zip((0.0, 1e9), RADII_S, strict=True):
        view.set_brush(radius_s=asked)
        assert view.radius_s == got


def test_another_take_is_looked_at_anew_with_the_same_tool(view: View) -> None:
    view.choose_tool("scale")
    view.set_brush(radius_s=2.0, strength=0.5)
    view.move_playhead(30)
    view.select((3, 9))
    view.reset()
    assert (view.playhead, view.selection, view.radius_s) == (0, None, BRUSH_S)
    assert (view.tool, view.strength) == ("scale", 0.5)


def test_the_shown_head_is_signalled_once_and_stays_with_another_take(view: View, signalled: list[Change]) -> None:
    head = bundled()
    view.show_on(head)
    view.show_on(head)
    assert view.head is head and signalled == [Change.HEAD]
    view.reset()
    assert view.head is head
    view.show_on(None)
    assert view.head is None and signalled == [Change.HEAD] * 2
