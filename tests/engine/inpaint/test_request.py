from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.errors import EditError
from engine.inpaint.request import FillRequest, checked, merged_pins
from engine.speech.visemes import Cue
from engine.take import SHAPE_INDEX, SHAPES, Take

TAKE = Take(np.full((60, len(SHAPES)), 0.2), 30.0)
GUIDE = Take(np.full((40, len(SHAPES)), 0.2), 30.0, np.arange(40) < 10)
SPAN = FillRequest((10, 20))
PINNED = {12: {"jawOpen": 0.5}}


@pytest.mark.parametrize(
    "request_",
    [
        SPAN,
        FillRequest((0, 60), "lower"),
        FillRequest((0, 60), pins={0: {"jawOpen": 1.1}, 59: {"jawOpen": -0.1}}),
        FillRequest((0, 60), guide=Take(np.zeros((60, 52)), 30.02)),
        FillRequest((0, 60), visemes=(Cue(0.0, 0.0, "M"),)),
        FillRequest((0, 60), controls={"lips_vertical": 1000.0}),
        FillRequest((5, 6), lost=True),
        FillRequest((5, 7), style="bridge"),
        FillRequest((10, 20), guide=GUIDE, guide_offset=-9),
        FillRequest((10, 20), guide=GUIDE, guide_offset=20),
        FillRequest((10, 20), pins={10: {"jawOpen": 0.0}, 19: {"jawOpen": 0.0}}),
        FillRequest((10, 20), controls={"lips_vertical": np.array([0.0, *[np.nan] * 9])}),
    ],
)
def test_what_fits_a_take_is_let_through(request_: FillRequest) -> None:
    found = checked(request_, TAKE)
    length = request_.frames[1] - request_.frames[0]
    assert replace(found, controls={}) == replace(request_, controls={}) or found.frames == request_.frames
    for name, curve in found.controls.items():
        np.testing.assert_array_equal(curve, np.broadcast_to(np.ravel(request_.controls[name]), (length,)))


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"frames": (20, 20)}, "Frames 20:20 are not within the take, which has 60 frames"),
        ({"frames": (-1, 5)}, "not within"),
        ({"frames": (50, 61)}, "not within"),
        ({"frames": (5, 6)}, "one frame cannot be filled"),
        ({"style": "slow"}, "no style called 'slow'"),
        ({"frames": (0, 60)}, "covers the whole take"),
        ({"region": "ears"}, "no region"),
        ({"pins": {9: {"jawOpen": 0.5}}}, "pin at frame 9 lies outside the span 10:20"),
        ({"pins": {20: {"jawOpen": 0.5}}}, "pin at frame 20 lies outside"),
        ({"pins": {12: {}}}, "moves nothing in the region 'face'"),
        ({"pins": PINNED, "region": "eyes"}, "moves nothing in the region 'eyes'"),
        ({"pins": {12: {"jawOpen": 1.11}}}, "sets jawOpen outside"),
        ({"pins": {12: {"jawOpen": -0.11}}}, "sets jawOpen outside"),
        ({"guide": replace(GUIDE, fps=30.04)}, "guide runs at 30.04 frames per second, the take at 30"),
        ({"guide": GUIDE, "guide_offset": -11}, "guide has 40 frames and does not cover the span, .* -1:9"),
        ({"guide": GUIDE, "guide_offset": 21}, "frames 31:41"),
        ({"guide": GUIDE, "guide_offset": -10}, "no face anywhere in the span"),
        ({"visemes": (Cue(0.0, 1.0, "quux"),)}, "quux"),
        ({"visemes": (Cue(1.0, 0.5, "M"),)}, "'M' ends before it begins"),
        ({"visemes": (Cue(0.0, float("inf"), "M"),)}, "'M' ends before it begins"),
        ({"controls": {"nose": 3.0}}, "nose"),
        ({"controls": {"lips_vertical": np.zeros(9)}}, "has 9 values where the span has 10 frames"),
        ({"controls": {"lips_vertical": np.zeros((10, 1))}}, "has 10 values"),
        ({"controls": {"lips_vertical": np.full(10, np.nan)}}, "asks for nothing"),
        ({"controls": {"lips_vertical": -0.1}}, "negative or beyond 1,000 mm"),
        ({"controls": {"lips_vertical": 1000.1}}, "negative or beyond 1,000 mm"),
    ],
)
def test_every_mistake_is_one_sentence(change: dict, says: str) -> None:
    with pytest.raises(EditError, match=says):
        checked(replace(SPAN, **change), TAKE)


def test_pins_of_one_frame_are_joined_unless_they_disagree() -> None:
    found = merged_pins([(3, {"jawOpen": 0.5}), (5, {"jawOpen": 0.1}), (3, {"tongueOut": 1.0, "jawOpen": 0.5})])
    assert list(found) == [3, 5]
    asked = {name: found[3][at] for name, at in SHAPE_INDEX.items() if np.isfinite(found[3][at])}
    assert asked == {"jawOpen": 0.5, "tongueOut": 1.0}
    with pytest.raises(EditError, match="Two pins at frame 3 ask for different values of jawOpen"):
        merged_pins([(3, {"jawOpen": 0.5}), (3, {"jawOpen": 0.6})])
    poses = FillRequest((0, 9), pins=PINNED).poses()
    assert list(poses) == [12] and np.isfinite(poses[12]).sum() == 1
