"""What is asked is stored as JSON and comes back to the bit; what was stored by no request is one sentence."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from engine.controls import ALL_CONTROLS
from engine.editing import (
    DEFAULT_BELIEVABILITY,
    VERBS,
    CleanRequest,
    ControlRequest,
    DragRequest,
    FillRequest,
    PasteRequest,
    PinRequest,
    Request,
    SmoothRequest,
    SpansRequest,
    WeightRequest,
    restored,
)
from engine.editing.requests import packed, unpacked
from engine.errors import EditError
from engine.pose import filled
from engine.regress import plausibility
from engine.retouch import PASTE_FEATHER_S, SMOOTH_FEATHER_S
from engine.take import SHAPES

numbers = st.floats(allow_nan=True, allow_infinity=False, width=64)


def curves(frames: int = 7, column: int = 0) -> np.ndarray:
    asked = np.full((frames, len(ALL_CONTROLS)), np.nan)
    asked[1:-1, column] = np.linspace(1 / 3, 9.0, frames - 2)
    return asked


def pose() -> np.ndarray:
    weights = np.full(len(SHAPES), np.nan)
    weights[17] = 2 / 3
    return weights


REQUESTS: dict[str, Request] = {
    "drag": DragRequest(40, curves(), 1 / 3),
    "drag of an extended control": DragRequest(0, curves(column=len(ALL_CONTROLS) - 1), 0.0),
    "control": ControlRequest("lips_vertical", (40, 60), "scale", 1 / 3, 1.0),
    "weight": WeightRequest("jawOpen", 12, np.linspace(0, 1, 9) / 3),
    "paste": PasteRequest(3, np.linspace(0, 1, 2 * len(SHAPES)).reshape(2, -1), 1 / 7),
    "smooth": SmoothRequest((3, 9), 20 / 3),
    "clean": CleanRequest((3, 9), 1 / 3),
    "pin": PinRequest({5: {"jawOpen": 1 / 3}, 7: pose()}, (1, 20), whole=False, closure=1 / 3),
    "pin as usual": PinRequest({5: {"jawOpen": 1 / 3}}, (1, 20)),
    "fill": FillRequest((40, 60), region="lower", pins={50: {"jawOpen": 0.1}}, seed=5),
    "spans": SpansRequest(((40, 60), (70, 90)), FillRequest((40, 90), controls={"lips_vertical": 3.0}, seed=2)),
}


def same(one: Any, other: Any) -> bool:
    """Return whether two requests say the same to the bit; poses by shape and as arrays are alike."""
    if is_dataclass(one):
        return type(one) is type(other) and all(
            same(getattr(one, each.name), getattr(other, each.name)) for each in fields(one)
        )
    if isinstance(one, np.ndarray) and not isinstance(other, Mapping):
        return one.dtype == other.dtype and np.array_equal(one, other, equal_nan=True)
    if isinstance(one, Mapping) and set(one) <= {*range(100)}:  # poses by frame
        return one.keys() == other.keys() and all(
            np.array_equal(filled(one[frame]), filled(other[frame]), equal_nan=True) for frame in one
        )
    return bool(one == other)


@pytest.mark.parametrize("name", list(REQUESTS))
def test_a_request_comes_back_from_json_to_the_bit(name: str) -> None:
    request = REQUESTS[name]
    again = restored(request.verb, json.loads(json.dumps(request.stored())))
    assert same(request, again) and again.frames == request.frames


def test_each_verb_is_tried() -> None:
    assert {request.verb for request in REQUESTS.values()} == set(VERBS)


@pytest.mark.parametrize("name", list(REQUESTS))
def test_a_request_that_lacks_a_part_is_one_sentence(name: str) -> None:
    request = REQUESTS[name]
    whole = json.loads(json.dumps(request.stored()))
    for key in whole.keys() - {"seed", "spans"}:  # a fill without a seed is of before seeds were part of it
        with pytest.raises(EditError, match="does not say what it was made from"):
            restored(request.verb, {other: value for other, value in whole.items() if other != key})


@pytest.mark.parametrize(
    ("verb", "change"),
    [
        ("drag", {"curves": {}}),
        ("drag", {"length": 8}),
        ("drag", {"curves": {"grin": {"shape": [7], "f8": ""}}}),
        ("paste", {"weights": {"shape": [2, 52], "f8": "AAAA"}}),
        ("paste", {"weights": {"shape": [2, 52], "f8": "not base64"}}),
        ("control", {"change": "double"}),
        ("smooth", {"frames": [1, 2, 3]}),
    ],
)
def test_what_no_request_stored_is_one_sentence(verb: str, change: dict[str, object]) -> None:
    with pytest.raises(EditError, match="does not say what it was made from"):
        restored(verb, {**REQUESTS[verb].stored(), **change})


def test_an_unknown_verb_is_one_sentence() -> None:
    with pytest.raises(EditError, match="does not say what it was made from"):
        restored("dance", {})


def test_a_drag_keeps_the_curves_that_ask_for_something_alone() -> None:
    assert list(DragRequest(0, curves()).stored()["curves"]) == [ALL_CONTROLS[0].name]


@settings(max_examples=30, deadline=None)
@given(array=arrays(np.float64, st.tuples(st.integers(0, 4), st.integers(1, 5)), elements=numbers))
def test_numbers_are_packed_to_the_bit(array: np.ndarray) -> None:
    again = unpacked(json.loads(json.dumps(packed(array))))
    assert again.shape == array.shape and again.tobytes() == array.tobytes()


def test_what_is_usual_is_what_the_methods_have() -> None:
    assert DEFAULT_BELIEVABILITY == plausibility.DEFAULT_BELIEVABILITY
    assert PasteRequest(0, np.zeros((1, 52))).feather_s == PASTE_FEATHER_S
    assert SmoothRequest((0, 1), 5.0).feather_s == SMOOTH_FEATHER_S
