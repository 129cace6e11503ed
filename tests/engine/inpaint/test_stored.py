"""A project remembers all that a fill was made from."""

from __future__ import annotations

import json

import numpy as np
import pytest

from engine.errors import EditError
from engine.inpaint.fill import refill
from engine.inpaint.request import FillRequest
from engine.speech.visemes import Cue
from engine.take import SHAPES, Take


def a_take(fps: float, seed: int = 1) -> Take:
    rng = np.random.default_rng(seed)
    frames = round(10 * fps)
    return Take(np.clip(0.3 + np.cumsum(rng.normal(0, 0.02, (frames, len(SHAPES))), axis=0), 0, 1), fps, name="rough")


def requests(fps: float) -> dict[str, FillRequest]:
    start, stop = round(4 * fps), round(5.5 * fps)
    span, curve = (start, stop), np.full(stop - start, np.nan)
    curve[5:20] = 1 / 3
    pose = np.full(len(SHAPES), np.nan)
    pose[17] = 2 / 3
    return {
        "nothing": FillRequest(span),
        "pins": FillRequest(span, pins={start + 3: {"jawOpen": 0.1}, start + 9: pose}),
        "controls": FillRequest(span, controls={"lips_vertical": curve, "corner_left": 31.7}),
        "guide": FillRequest(span, guide=a_take(fps, 2), guide_offset=-round(fps)),
        "guide at its end": FillRequest(span, guide=a_take(fps, 2), guide_offset=round(10 * fps) - stop),
        "visemes": FillRequest(span, visemes=(Cue(4.1, 4.3, "AA"), Cue(4.3, 4.5, "M"))),
        "others": FillRequest(span, region="lower", besides=((3, 9), (200, 230)), unmade=((3, 9),), lost=True),
        "bridge": FillRequest(span, style="bridge"),
        "another seed": FillRequest(span, style="perform", seed=3),
    }


@pytest.mark.parametrize("fps", [30.0, 60000 / 1001])
@pytest.mark.parametrize("name", list(requests(30.0)))
def test_what_is_stored_makes_the_same_motion_bit_for_bit(fps: float, name: str) -> None:
    take, request = a_take(fps), requests(fps)[name]
    again = FillRequest.restored(json.loads(json.dumps(request.stored())))
    once, twice = (refill(take, each)[0].take.weights for each in (request, again))
    np.testing.assert_array_equal(once, twice)
    assert again.stored() == request.stored()


@pytest.mark.parametrize(
    "change",
    [
        {"controls": ["lips_vertical"]},  # as it was written before the values were kept
        {"guide_frames": None},
        {"guide_frames": {"fps": 30.0, "frames": 10**12, "first": 0, "weights": "", "lost": []}},
        {"guide_frames": {"fps": 30.0, "frames": 5, "first": 3, "weights": "AAAA", "lost": []}},
        {"frames": [1]},
        {"pins": {"x": {}}},
        {"pins": []},
        {"visemes": [[1, 2]]},
        {"besides": 3},
    ],
)
def test_what_cannot_be_made_again_is_one_sentence(change: dict[str, object]) -> None:
    whole = json.loads(json.dumps(requests(30.0)["guide"].stored()))
    with pytest.raises(EditError, match="does not say what it was made from"):
        FillRequest.restored({**whole, **change})
    for key in whole.keys() - {"seed"}:  # which was kept beside the request before
        with pytest.raises(EditError):
            FillRequest.restored({name: value for name, value in whole.items() if name != key})
