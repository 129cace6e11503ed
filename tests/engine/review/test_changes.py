from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.controls import CONTROL_INDEX, measure
from engine.formats import read_take
from engine.lab.performer import demo
from engine.review.changes import Edited, compare
from engine.take import SHAPE_INDEX, Take

RECORDED = read_take(demo.BUNDLED)
# No lost frames: those beside a changed one are interpolated anew, which is a change too.
DEMO = Take(RECORDED.weights, RECORDED.fps, name=RECORDED.name)
JAW = SHAPE_INDEX["jawOpen"]


def opened_wider(start: int, stop: int, by: float = 0.3, shape: int = JAW) -> Take:
    weights = DEMO.weights.copy()
    weights[start:stop, shape] += by
    return DEMO.with_weights(weights)


def test_a_take_compared_with_itself_has_no_change() -> None:
    found = compare(DEMO, DEMO)
    assert not found.changes and not found.differs.any() and found.identical == len(DEMO)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 250), st.integers(1, 60))
def test_the_frames_that_differ_are_exactly_those_that_were_changed(start: int, length: int) -> None:
    stop = min(len(DEMO), start + length)
    found = compare(DEMO, opened_wider(start, stop))
    assert [(change.start, change.stop) for change in found.changes] == [(start, stop)]
    assert found.identical == len(DEMO) - (stop - start)


def test_a_change_says_what_moved_where_and_by_how_much() -> None:
    after = opened_wider(100, 120)
    (change,) = compare(DEMO, after, edits=[Edited("Drag lips apart", 90, 125), Edited("Clean", 0, 50)]).changes
    lips = CONTROL_INDEX["lips_vertical"]
    by_mm = (measure(after.weights) - measure(DEMO.weights))[change.peak, lips]
    assert change.region == "lower" and change.control == "lips apart"
    assert change.by_mm == by_mm and change.weight == pytest.approx(0.3)
    assert change.edits == ("Drag lips apart",) and change.moved_mm > 3


def test_one_eye_is_told_from_both() -> None:
    (change,) = compare(DEMO, opened_wider(20, 40, shape=SHAPE_INDEX["eyeBlinkLeft"])).changes
    assert change.region in ("left", "eyes")


def test_changes_close_together_are_one_and_far_apart_are_two() -> None:
    near, far = opened_wider(50, 60), opened_wider(50, 60)
    near_weights, far_weights = near.weights.copy(), far.weights.copy()
    near_weights[63:70, JAW] += 0.2
    far_weights[80:90, JAW] += 0.2
    assert len(compare(DEMO, DEMO.with_weights(near_weights)).changes) == 1
    assert len(compare(DEMO, DEMO.with_weights(far_weights)).changes) == 2


def test_another_rate_alone_is_no_change() -> None:
    half = Take(DEMO.weights[::2], DEMO.fps / 2, name="half")
    assert not compare(DEMO, half, offset_s=0.0).changes
