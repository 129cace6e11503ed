"""What the lanes show of a session, on lanes that note what they are given."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.curves import drawing
from app.curves.peaks import on_screen
from app.session import Session
from app.session.curve_table import CURVES, FIRST_WEIGHT
from engine.editing import Patch
from engine.extended import bundled_face
from engine.take import SHAPES, Take


class NotingLane:
    """Notes each call by its name."""

    def __init__(self, key: int) -> None:
        self.key, self.curve = key, CURVES[key]
        self.calls: list[tuple[str, tuple[Any, ...], dict[str, Any]]] = []

    def __getattr__(self, name: str) -> Any:
        return lambda *given, **named: self.calls.append((name, given, named))

    @property
    def names(self) -> list[str]:
        return [name for name, _, _ in self.calls]


@pytest.fixture
def session(qtbot: QtBot) -> Session:
    weights = np.random.default_rng(0).random((90, len(SHAPES)))
    opened = Session(Take(weights, 30.0, np.arange(90) == 12))
    opened.view.set_range(20, 60)
    return opened


@pytest.fixture
def lanes() -> Any:
    return [NotingLane(0), NotingLane(FIRST_WEIGHT + 3)]


def drafted(session: Session) -> Patch:
    weights = np.random.default_rng(1).random((8, len(SHAPES)))
    reached = bundled_face().measure(weights)
    draft = Patch(10, weights, reached + 1, reached)
    session.document.draft = draft
    return draft


def test_lanes_take_their_own_curves_and_then_choose_their_range(session: Session, lanes: Any) -> None:
    drawing.take_curves(lanes, session)
    for lane in lanes:
        (_, (original, reached, _), named), (then, _, _) = lane.calls
        np.testing.assert_array_equal(original, session.document.original_curve(lane.key))
        np.testing.assert_array_equal(reached, session.document.curve(lane.key))
        assert named == {"touched": session.document.touched} and lane.names == ["take_curves", "fit"] and then == "fit"


def test_lanes_show_the_frames_of_the_view(session: Session, lanes: Any) -> None:
    drawing.show_frames(lanes, session)
    for lane in lanes:
        assert lane.calls[0][:2] == ("show_frames", (20, 60))
        assert lane.calls[1][:2] == ("draw_original", (on_screen(90, (20, 60)),))


def test_a_draft_is_drawn_over_its_frames_with_what_was_asked_of_controls_alone(session: Session, lanes: Any) -> None:
    drawing.draw_edits(lanes, session)
    assert all(lane.calls == [("draw_edit", (on_screen(90, (20, 60)),), {})] for lane in lanes)
    draft = drafted(session)
    drawing.draw_edits(lanes, session)
    control, weight = (lane.calls[-1][1] for lane in lanes)
    np.testing.assert_array_equal(control[1][0], draft.reached[:, 0])
    np.testing.assert_array_equal(control[2][0], draft.asked[:, 0])
    np.testing.assert_array_equal(weight[1][0], draft.weights[:, 3])
    assert control[1][1] == control[2][1] == weight[1][1] == 10 and weight[2] is None


@pytest.mark.parametrize(
    ("tool", "shown", "there"), [("clean", True, True), ("clean", False, False), ("drag", True, False)]
)
def test_what_cleaning_takes_off_is_drawn_while_it_is_chosen_and_wanted(
    session: Session, lanes: Any, tool: str, shown: bool, there: bool
) -> None:
    session.view.tool, session.view.shows_removed = tool, shown
    drawing.draw_removed(lanes, session)
    assert all(lane.names == ["hide_removed"] for lane in lanes)
    draft = drafted(session)
    drawing.draw_removed(lanes, session)
    for lane in lanes:
        assert lane.names[-1] == ("draw_removed" if there else "hide_removed")
        if there:
            _, (taken_off, start), named = lane.calls[-1]
            now = (draft.reached if lane.key == 0 else draft.weights)[:, lane.curve.column]
            np.testing.assert_allclose(taken_off, session.document.curve(lane.key)[10:18] - now)
            assert start == 10 and named["kept"].tolist() == [True, True, False, *[True] * 5]


def test_differences_are_drawn_while_somebody_reviews_them(lanes: Any) -> None:
    now, before = np.arange(90.0), np.arange(90.0) * 2
    document = SimpleNamespace(
        take=Take(np.zeros((90, len(SHAPES))), 30.0),
        original="before",
        differences=None,
        curve=lambda key: now + key,
        original_curve=lambda key: before,
    )
    view = SimpleNamespace(range=(20, 60), playhead=33, tool="review")
    session: Any = SimpleNamespace(document=document, view=view)
    for differences, tool in ((None, "review"), ((), "drag")):
        document.differences, view.tool = differences, tool
        drawing.draw_differences(lanes, session)
        drawing.tell_differences(lanes, session)
        assert not lanes[0].calls
    view.tool = "review"
    drawing.draw_differences(lanes, session)
    drawing.tell_differences(lanes, session)
    for lane in lanes:
        (_, (takes, measure), _), drawn, told = lane.calls
        assert takes == (document.take, "before")
        np.testing.assert_array_equal(measure(), now + lane.key - before)
        assert drawn[:2] == ("draw_difference", (on_screen(90, (20, 60)), 33))
        assert told[:2] == ("tell_difference", (33,))
