from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QRectF
from pytestqt.qtbot import QtBot

from app.curves.lane import LEAST_MM, Lane
from app.curves.places import GUTTER_PX
from app.curves.removed import SHARE
from app.session.curve_table import CURVES, FIRST_WEIGHT
from app.theme import DARK
from engine.take import SHAPES, Take

BOX = QRectF(GUTTER_PX, 40, 600, 80)


def a_lane(*curves: np.ndarray | None, key: int = 0) -> Lane:
    lane = Lane(key)
    lane.place(BOX)
    lane.paint_with(DARK)
    original, reached, asked = (*curves, None, None)[:3]
    assert original is not None
    lane.take_curves(original, original if reached is None else reached, asked, touched=(0, len(original)))
    lane.fit()
    lane.show_frames(0, 100)
    return lane


def test_places_and_values_go_there_and_back(qtbot: QtBot) -> None:
    lane = a_lane(np.linspace(10, 30, 200))
    lane.set_range(10, 30)
    assert [lane.y_of(value) for value in (30, 20, 10)] == [40, 80, 120]
    assert [lane.x_of(frame) for frame in (0, 50, 100)] == [150, 450, 750]
    for value in (3.0, 11.0, 40.0):
        assert lane.value_at(lane.y_of(value)) == pytest.approx(value)
        assert lane.frame_at(lane.x_of(value)) == pytest.approx(value)
    assert lane.gutter.geometry() == QRectF(0, 40, GUTTER_PX, 80) and lane.scene_box() == BOX


def test_all_curves_have_room_with_a_margin(qtbot: QtBot) -> None:
    first, second, third = (np.linspace(*ends, 200) for ends in ((10, 30), (10, 40), (5, 30)))
    lane = a_lane(first, second, third)
    assert lane.gutter.range == (5, 40)
    assert lane.range == pytest.approx((5 - 0.08 * 35, 40 + 0.08 * 35))


def test_a_level_curve_is_shown_within_four_millimetres_and_a_lively_one_with_a_little_to_spare(qtbot: QtBot) -> None:
    assert a_lane(np.full(200, 20.0)).range == pytest.approx((18, 22))
    assert a_lane(np.linspace(20, 21, 200)).range == pytest.approx((18.5, 22.5))


def test_weights_are_shown_from_nothing_to_one_and_further_where_they_go(qtbot: QtBot) -> None:
    for ends, shown in (((0.2, 0.4), (0, 1)), ((-0.5, 1.5), (-0.5, 1.5))):
        lane = a_lane(np.linspace(*ends, 200), key=FIRST_WEIGHT)
        assert lane.gutter.range == pytest.approx(shown)
        assert lane.range == pytest.approx((shown[0] - 0.06, shown[1] + 0.06))


def takes() -> tuple[Take, Take]:
    return Take(np.zeros((200, len(SHAPES))), 30.0), Take(np.ones((200, len(SHAPES))), 30.0)


def test_a_difference_is_measured_once_for_two_takes(qtbot: QtBot) -> None:
    lane, pair, measured = a_lane(np.linspace(10, 30, 200)), takes(), []

    def measure() -> np.ndarray:
        measured.append(None)
        return np.linspace(-2, 2, 200)

    first = lane.difference(pair, measure)
    assert lane.difference(pair, measure) is first and len(measured) == 1
    lane.difference((pair[1], pair[1]), measure)
    lane.difference((pair[1], pair[0]), measure)
    assert len(measured) == 3


def test_a_difference_is_told_with_its_sign_below_the_curve(qtbot: QtBot) -> None:
    lane = a_lane(np.linspace(10, 30, 200))
    fitted = lane.range
    curve = np.zeros(200)
    curve[7], curve[9] = 1.25, -2.0
    lane.difference(takes(), lambda: curve)
    lane.draw_difference((0, 100), 7)
    assert lane.gutter.removed.startswith("Δ +1.2 of ±") and lane.gutter.removed.endswith(" mm")
    assert lane.gutter.removed_short == "Δ +1.2" and lane.gutter.spare == SHARE
    assert lane.range[1] == fitted[1]
    assert (fitted[0] - lane.range[0]) / (lane.range[1] - lane.range[0]) == pytest.approx(SHARE)
    lane.tell_difference(9)
    assert lane.gutter.removed_short == "Δ -2.0"
    lane.hide_removed()
    assert lane.gutter.removed == "" and lane.range == pytest.approx(fitted)


def test_a_weight_s_difference_is_told_with_two_places(qtbot: QtBot) -> None:
    lane = a_lane(np.linspace(0, 1, 200), key=FIRST_WEIGHT)
    lane.difference(takes(), lambda: np.full(200, 0.25))
    lane.draw_difference((0, 100), 3)
    assert lane.gutter.removed_short == "Δ +0.25" and "mm" not in lane.gutter.removed


@pytest.mark.parametrize(("largest", "told"), [(0.49 * LEAST_MM, False), (0.5 * LEAST_MM, True)])
def test_a_difference_too_small_to_be_read_is_none(qtbot: QtBot, largest: float, told: bool) -> None:
    lane = a_lane(np.linspace(10, 30, 200))
    lane.difference(takes(), lambda: np.where(np.arange(200) == 7, -largest, 0.0))
    lane.draw_difference((0, 100), 7)
    assert bool(lane.gutter.removed) == told
    other = a_lane(np.linspace(10, 30, 200))
    other.tell_difference(3)
    assert other.gutter.removed == ""


def test_what_cleaning_takes_off_is_told_by_its_full_scale(qtbot: QtBot) -> None:
    for key, unit in ((0, f" {CURVES[0].unit}"), (FIRST_WEIGHT, "")):
        lane = a_lane(np.linspace(0, 1, 200), key=key)
        lane.draw_removed(np.full(50, 0.3), 10, kept=np.ones(50, bool), visible=(0, 100))
        assert lane.gutter.removed == f"removed {lane.gutter.removed_short}"
        assert lane.gutter.removed_short.startswith("±") and lane.gutter.removed_short.endswith(unit)
        assert float(lane.gutter.removed_short[1:].removesuffix(unit)) >= 0.3 and lane.gutter.spare == SHARE


def test_a_lane_that_is_put_away_is_hidden_and_drawn_anew(qtbot: QtBot) -> None:
    lane = a_lane(np.linspace(10, 30, 200))
    lane.put_away()
    assert not lane.view.isVisible() and not lane.gutter.isVisible() and not lane.dot.isVisible()
    with pytest.raises(AssertionError):
        lane.draw_original((0, 100))
