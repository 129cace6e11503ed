from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.anatomy import EXCLUSIVE, pairs
from engine.character import bundled
from engine.errors import AssetError
from engine.formats.livelink.sides import exchange
from engine.quality import Seen, flags_of
from engine.quality.shape import crossed_mm, crossing, impossible, out_of_range, swapped
from engine.take import SHAPE_INDEX, SHAPES, Array
from tests.engine.quality.takes import (
    CLOSED,
    CLOSED_FACE,
    EVERY,
    JAW,
    found,
    looked,
    still,
)


def test_lips_that_pass_through_each_other_are_flagged() -> None:
    weights = still()
    weights[70:80] = 0.0
    weights[70:80, CLOSED] = list(CLOSED_FACE.values())
    assert found(looked(weights), "through") == [(70, 80)]


def test_exchanged_sides_are_flagged() -> None:
    rng = np.random.default_rng(0)
    weights = still(600)
    way = np.convolve(rng.normal(0, 1, 650), np.ones(51) / 7, "valid")
    for shape in ("mouth", "mouthDimple", "mouthStretch", "cheekSquint", "mouthUpperUp"):
        weights[:, SHAPE_INDEX[f"{shape}Left"]] = 0.2 + 0.1 * np.clip(way, 0, 2)
        weights[:, SHAPE_INDEX[f"{shape}Right"]] = 0.2 + 0.1 * np.clip(-way, 0, 2)
    assert not found(looked(weights), "swapped")
    assert found(looked(exchange(weights)), "swapped") == [(0, 600)]


def only(weights: Array, **more: object) -> Seen:
    return replace(Seen(weights, np.zeros((len(weights), 16)), 30.0, np.zeros(len(weights), bool)), **more)


@pytest.mark.parametrize(("beyond", "flagged"), [(0.01, True), (0.0, False)])
def test_two_shapes_that_exclude_each_other_are_named_with_the_lesser_weight(beyond: float, flagged: bool) -> None:
    for one, other, row in pairs():
        first, second, reason = EXCLUSIVE[row]
        limit = 0.65 if second == "mouthStretch" else 0.5
        weights = np.zeros((20, len(SHAPES)))
        weights[5:8, one], weights[5:8, other] = 0.9, limit + beyond
        weights[6, other] = 0.8 if flagged else limit
        flags = list(impossible(only(weights), 0, 20))
        assert [(flag.start, flag.stop) for flag in flags] == [(5, 8)] * flagged
        if flagged:
            assert flags[0].sentence == f"{first} and {second} are both at 0.80 or more: {reason}."
            assert flags[0].weight == pytest.approx(0.2 + 0.8 * (0.8 - limit) / (1 - limit))


@pytest.mark.parametrize(
    ("value", "beyond"), [(1.06, 0.01), (1.3, 0.25), (-0.03, 0.01), (-0.27, 0.25), (1.05, 0), (-0.02, 0)]
)
def test_a_weight_out_of_range_is_named_and_weighs_by_how_far(value: float, beyond: float) -> None:
    weights = np.full((20, len(SHAPES)), 0.5)
    weights[9, 40] = value
    flags = list(out_of_range(only(weights), 0, 20))
    assert [(flag.start, flag.stop) for flag in flags] == [(9, 10)] * (beyond > 0)
    if beyond:
        assert flags[0].weight == pytest.approx(0.2 + 0.8 * beyond / 0.5)
        assert flags[0].sentence.startswith(f"{SHAPES[40]} is at {value:.2f}")
    assert not list(out_of_range(only(weights, lost=np.arange(20) == 9), 0, 20))


def test_how_far_lips_and_lids_cross_is_told_by_the_head_s_landmarks() -> None:
    rng = np.random.default_rng(0)
    head, weights = bundled(), rng.random((12, len(SHAPES))) * 1.5 - 0.25
    drawn = weights.copy()
    close, jaw = SHAPE_INDEX["mouthClose"], SHAPE_INDEX["jawOpen"]
    drawn[:, close] = np.minimum(weights[:, close], np.maximum(weights[:, jaw], 0))
    places = {name: head.neutral[at] + drawn @ head.deltas[:, at] for name, at in head.landmarks.items()}

    def height(upper: str, lower: str) -> Array:
        return (places[lower] - places[upper])[:, 1]

    np.testing.assert_allclose(crossed_mm(weights, "lip"), height("lip_inner_upper", "lip_inner_lower"), atol=1e-4)
    both = [height(f"lid_upper_{side}", f"lid_lower_{side}") for side in ("left", "right")]
    np.testing.assert_allclose(crossed_mm(weights, "lid"), np.maximum(*both), atol=1e-4)


@pytest.mark.parametrize(("lid", "flags"), [("eyeBlinkLeft", 1), ("eyeBlinkRight", 1)])
def test_a_lid_far_through_the_other_is_flagged_on_either_side(lid: str, flags: int) -> None:
    weights = np.zeros((30, len(SHAPES)))
    slope = crossed_mm(np.where(np.arange(len(SHAPES)) == SHAPE_INDEX[lid], 2.0, 0.0)[None], "lid")[0]
    for through_mm, flagged in ((4.4, False), (6.25, True)):
        rest = crossed_mm(weights[:1], "lid")[0]
        one = crossed_mm(np.where(np.arange(len(SHAPES)) == SHAPE_INDEX[lid], 1.0, 0.0)[None], "lid")[0]
        weights[10:13, SHAPE_INDEX[lid]] = 1 + (through_mm - one) / (slope - one)
        found = [flag for flag in crossing(only(weights), 0, 30) if "lids" in flag.sentence]
        assert rest < 0 and [(flag.start, flag.stop) for flag in found] == [(10, 13)] * flagged
        if flagged:
            assert found[0].weight == pytest.approx(0.2 + 0.8 * 1.75 / 3.5, abs=1e-3)
            assert not list(crossing(only(weights, lost=np.ones(30, bool)), 0, 30))
        weights[:] = 0.0


def test_short_takes_tell_nothing_of_their_sides() -> None:
    way = np.sin(np.arange(400) / 9)
    weights = still(400)
    for shape in ("mouth", "mouthDimple", "mouthStretch", "cheekSquint", "mouthUpperUp"):
        weights[:, SHAPE_INDEX[f"{shape}Left"]] = 0.2 + 0.1 * np.clip(way, 0, 2)
        weights[:, SHAPE_INDEX[f"{shape}Right"]] = 0.2 + 0.1 * np.clip(-way, 0, 2)
    wrong = exchange(weights)
    assert list(swapped(only(wrong[:300]), 0, 300)) and not list(swapped(only(wrong[:299]), 0, 299))
    (flag,) = swapped(only(wrong), 0, 400)
    told = float(flag.sentence.split("correlation ")[1].rstrip(").").replace("−", "-"))
    assert told < -0.35 and flag.weight == pytest.approx(min(1.0, 0.2 + 0.8 * (-told - 0.35) / 0.55), abs=0.01)


def test_gaze_may_go_a_little_beyond_one_as_trackers_report_it() -> None:
    weights = still()
    weights[50:60, SHAPE_INDEX["eyeLookInRight"]] = 1.08
    weights[80:90, SHAPE_INDEX["mouthLeft"]] = 1.08
    weights[120:130, SHAPE_INDEX["eyeLookInRight"]] = 1.2
    assert found(looked(weights), "range") == [(80, 90), (120, 130)]


def test_lips_that_are_rounded_and_wide_may_go_as_far_as_people_did() -> None:
    weights = still() * 0.1
    for start, strength in ((50, 0.56), (100, 0.7)):
        for name in ("mouthFunnel", "mouthStretchLeft", "mouthStretchRight"):
            weights[start : start + 10, SHAPE_INDEX[name]] = strength
    weights[150:160, [SHAPE_INDEX["mouthSmileLeft"], SHAPE_INDEX["mouthFrownLeft"]]] = 0.56
    assert found(looked(weights), "impossible") == [(100, 110), (150, 160)]


def test_a_mouth_that_nobody_was_recorded_to_make_is_flagged_and_a_missing_prior_takes_no_other_flag_away(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    weights = still() * 0.3
    names = ("mouthStretchLeft", "mouthStretchRight", "mouthFrownLeft", "mouthLeft", "mouthUpperUpRight", "jawOpen")
    weights[60:70, [SHAPE_INDEX[name] for name in names]] = 1.0
    assert found(looked(weights), "unlike") == [(60, 70)]
    text = next(flag.sentence for flag in flags_of(looked(weights), EVERY) if flag.kind == "unlike")
    assert "further from its mean pose than all 4,000 recorded faces" in text

    def missing() -> None:
        raise AssetError("The model file is missing.", "Train it.")

    monkeypatch.setattr("engine.quality.shape.recorded", missing)
    weights[200, JAW] += 0.5
    assert not found(looked(weights), "unlike") and found(looked(weights), "spike") == [(200, 201)]
