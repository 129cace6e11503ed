from __future__ import annotations

import pytest
from PySide6.QtCore import QSizeF
from PySide6.QtWidgets import QGraphicsScene
from pytestqt.qtbot import QtBot

from app.curves.places import GAP_PX, boxes
from app.curves.stack import NEAR_PX, LaneStack

SIZE, SHARES = QSizeF(800, 300), {0: 2.4, 3: 1.0, 5: 1.0}


@pytest.fixture
def stack(qtbot: QtBot) -> LaneStack:
    stack = LaneStack(QGraphicsScene())
    stack.show([0, 3, 5])
    stack.place(SIZE, SHARES)
    return stack


def test_lanes_are_those_that_are_asked_for_in_that_order(stack: LaneStack) -> None:
    assert stack.keys == [0, 3, 5] and not stack.show([0, 3, 5])
    away = stack.known[3]
    assert stack.show([5, 0]) and stack.keys == [5, 0]
    assert not away.view.isVisible() and stack.known[0].view.isVisible()
    assert stack.show([5, 3]) and stack.known[3] is away and away.view.isVisible() and away.gutter.isVisible()
    assert len(stack.known) == 3


def test_each_lane_is_where_the_panel_s_size_and_its_share_have_it(stack: LaneStack) -> None:
    wanted = boxes(SIZE, [0, 3, 5], SHARES)
    assert [lane.scene_box() for lane in stack.shown] == wanted
    assert stack.box().top() == wanted[0].top() and stack.box().bottom() == wanted[-1].bottom()


def test_what_lies_under_a_height_counts_from_just_beside_a_lane(stack: LaneStack) -> None:
    assert GAP_PX == 2 * NEAR_PX  # so that every height between two lanes is one of them
    first, second, _ = (lane.scene_box() for lane in stack.shown)
    assert stack.at(first.top() - NEAR_PX) == 0 and stack.at(first.top() - NEAR_PX - 0.5) is None
    assert stack.at(first.bottom() + NEAR_PX - 0.5) == 0 and stack.at(first.bottom() + NEAR_PX) == 3
    assert stack.at(second.center().y()) == 3
    assert stack.at(stack.box().bottom() + NEAR_PX) is None


def test_a_frame_is_across_the_lanes_as_much_as_across_the_view(stack: LaneStack) -> None:
    box = stack.box()
    assert stack.x_of(20, (20, 120)) == box.left() and stack.x_of(120, (20, 120)) == box.right()
    assert stack.x_of(45, (20, 120)) == box.left() + box.width() / 4
    assert stack.x_of(5, (5, 5)) == box.left()


def test_the_gutter_shows_which_lane_is_worked_on_and_which_are_open(stack: LaneStack) -> None:
    stack.mark(3, frozenset({5}))
    assert [lane.gutter.active for lane in stack.shown] == [False, True, False]
    assert [lane.gutter.expanded for lane in stack.shown] == [False, False, True]
