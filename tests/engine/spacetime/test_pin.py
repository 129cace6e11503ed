from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.controls import CONTROL_INDEX, measure
from engine.errors import EditError
from engine.formats import read_take
from engine.lab.performer import demo
from engine.spacetime.pin import PinSolver, Spreading, pin, pose_reaching
from engine.take import SHAPE_INDEX, Take

LIPS = CONTROL_INDEX["lips_vertical"]
SMILE = {"mouthSmileLeft": 0.8, "mouthSmileRight": 0.8}
SMILES = [SHAPE_INDEX[name] for name in SMILE]


@pytest.fixture(scope="module")
def take() -> Take:
    return read_take(demo.BUNDLED)


def test_a_pin_is_met_and_nothing_outside_its_range_changes(take: Take) -> None:
    edited = pin(take, {68: SMILE}, (63, 75))
    assert (edited.weights[68, SMILES] == 0.8).all()
    outside = np.r_[0:63, 75 : len(take)]
    assert edited.weights[outside].tobytes() == take.weights[outside].tobytes()
    others = np.setdiff1d(np.arange(52), SMILES)
    np.testing.assert_array_equal(edited.weights[68, others], take.weights[68, others])


def test_the_smile_arrives_and_leaves_while_the_speech_goes_on(take: Take) -> None:
    free = Spreading(closure=0.0)
    edited = pin(take, {68: SMILE}, (60, 77), spreading=free)
    change = (edited.weights - take.weights)[:, SMILES]
    rise = np.arange(1, 10) / 9  # from the frame before the range to the pin
    np.testing.assert_allclose(change[60:69], rise[:, None] * change[68], atol=1e-9)
    np.testing.assert_allclose(change[68:77], rise[::-1, None] * change[68], atol=1e-9)
    jaw = SHAPE_INDEX["jawOpen"]
    np.testing.assert_allclose(edited.weights[:, jaw], take.weights[:, jaw], atol=1e-9)


def test_pinning_what_is_there_changes_nothing(take: Take) -> None:
    edited = pin(take, {68: take.weights[68].copy()}, (40, 100), spreading=Spreading(alpha=0.02))
    np.testing.assert_allclose(edited.weights, take.weights, atol=1e-12)


def _talking(frames: int = 40) -> Take:
    """Lips that meet twice, six frames apart, beside the frame that is pinned."""
    weights = np.zeros((frames, 52))
    opened = 0.25 * np.ones(frames)
    opened[[17, 18, 24, 25]] = 0.0
    weights[:, SHAPE_INDEX["jawOpen"]] = opened
    weights[:, SHAPE_INDEX["mouthLowerDownLeft"]] = weights[:, SHAPE_INDEX["mouthLowerDownRight"]] = opened / 2
    return Take(weights, 30.0)


def test_lips_that_meet_in_the_take_still_meet_beside_a_wide_open_pin() -> None:
    take = _talking()
    pins = {21: {"jawOpen": 0.8}}
    closed = [17, 18, 24, 25]
    held = measure(pin(take, pins, (10, 33)).weights)[closed, LIPS]
    loose = measure(pin(take, pins, (10, 33), spreading=Spreading(closure=0.0)).weights)[closed, LIPS]
    assert loose.min() > 10
    assert held.max() < 2


def test_lips_that_a_pin_parts_open_gradually() -> None:
    silent = Take(np.zeros((40, 52)), 30.0)
    edited = pin(silent, {20: {"jawOpen": 0.5}}, (10, 31))
    jaw = edited.weights[9:21, SHAPE_INDEX["jawOpen"]]
    np.testing.assert_allclose(jaw, np.linspace(0, 0.5, 12), atol=1e-9)


def test_a_single_weight_pins_and_leaves_the_rest_free(take: Take) -> None:
    edited = pin(take, {68: {"jawOpen": 0.7}}, (60, 77), whole=False, spreading=Spreading(alpha=0.01))
    assert edited.weights[68, SHAPE_INDEX["jawOpen"]] == 0.7
    others = np.setdiff1d(np.arange(52), SHAPE_INDEX["jawOpen"])
    assert (edited.weights[68, others] != take.weights[68, others]).any()


def test_a_control_becomes_a_pose() -> None:
    take = _talking()
    pose = pose_reaching(take, 5, {"lips_vertical": 2.0})
    assert measure(pose[None])[0, LIPS] == pytest.approx(2.0, abs=0.1)
    edited = pin(take, {5: pose}, (0, 12))
    np.testing.assert_array_equal(edited.weights[5], pose)


def test_a_moving_slider_equals_pinning_anew(take: Take) -> None:
    solver = PinSolver(take, {68: SMILE, 80: {"jawOpen": 0.3}}, (55, 100))
    for amount in (0.0, 0.4, 1.0):
        pins = {68: {"mouthSmileLeft": amount}, 80: {"jawOpen": 0.3 * amount}}
        np.testing.assert_array_equal(solver.take(pins).weights, pin(take, pins, (55, 100)).weights)


def test_a_range_at_the_end_of_the_take_keeps_the_change(take: Take) -> None:
    last = len(take) - 1
    edited = pin(take, {last - 3: SMILE}, (last - 10, last + 1), spreading=Spreading(closure=0.0))
    change = (edited.weights - take.weights)[:, SMILES]
    np.testing.assert_allclose(change[last], change[last - 3], atol=0.25)
    assert (change[last] > 0.5).all()


def test_weights_stay_in_range_beside_a_pin(take: Take) -> None:
    edited = pin(take, {68: {name: 0.0 for name in SHAPE_INDEX}}, (50, 90))
    assert edited.weights.min() >= min(0.0, take.weights.min())
    assert edited.weights.max() <= max(1.0, take.weights.max())


def test_a_take_of_one_frame_can_be_pinned() -> None:
    edited = pin(Take(np.zeros((1, 52)), 30.0), {0: SMILE}, (0, 1))
    assert edited.weights[0, SMILES[0]] == 0.8


@pytest.mark.parametrize(
    ("pins", "frames", "says"),
    [
        ({80: SMILE}, (63, 75), "not within the range"),
        ({75: SMILE}, (63, 75), "pin at frame 75 is not within the range 63:75"),
        ({62: SMILE}, (63, 75), "pin at frame 62"),
        ({68: SMILE}, (63, 10**6), "not within the take"),
        ({}, (63, 75), "no pin"),
        ({68: {"grin": 1.0}}, (63, 75), "'grin'"),
        ({68: {"jawOpen": float("nan")}}, (63, 75), "not a number that a face could take"),
        ({68: np.zeros(3)}, (63, 75), "52 finite"),
    ],
)
def test_pins_that_make_no_sense_are_refused(take: Take, pins: dict, frames: tuple[int, int], says: str) -> None:
    with pytest.raises(EditError, match=says):
        pin(take, pins, frames)


def test_a_real_take_stays_as_it_is_outside_the_range(real_take_path: Path) -> None:
    take = read_take(real_take_path)
    edited = pin(take, {1610: SMILE}, (1590, 1640))
    assert edited.weights[:1590].tobytes() == take.weights[:1590].tobytes()
    assert edited.weights[1640:].tobytes() == take.weights[1640:].tobytes()
    gaps = [measure(each.weights)[1590:1640, LIPS] for each in (take, edited)]
    assert not ((gaps[0] < 1.5) & (gaps[1] > 3.0)).any()


def test_beside_a_pinned_smile_lips_that_met_meet_on_the_face_as_it_is_drawn(take: Take) -> None:
    solved = PinSolver(take, {80: SMILE}, (50, 111)).solve({80: SMILE})
    before, after = measure(take.weights[50:111])[:, LIPS], measure(solved)[:, LIPS]
    shut = before < 1.5
    assert shut.sum() > 10 and (after[shut] < before[shut] + 0.1).all()
    assert np.abs(np.diff(after)).max() <= np.abs(np.diff(before)).max() + 0.1  # and none of them pops
