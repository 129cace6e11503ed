from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.controls import ALL_CONTROLS, measure
from engine.formats import read_take
from engine.lab.performer import demo
from engine.quality import (
    CLOSED_MM,
    Seen,
    flags_of,
)
from engine.quality.lips import close_above_jaw, off_teeth, stay_open
from engine.speech.lane import attached
from engine.speech.visemes import Cue
from engine.take import SHAPE_INDEX, SHAPES, Array, runs
from tests.engine.quality.takes import (
    JAW,
    LIPS,
    found,
    looked,
    still,
)


def test_lips_that_are_told_to_meet_are_flagged_until_they_do() -> None:
    take = read_take(demo.BUNDLED)
    lips = measure(take.weights)[:, LIPS]
    wide = int(np.argmax(np.where(take.lost, -1, lips)))
    lane = attached([Cue((wide - 1) / take.fps, (wide + 2) / take.fps, "B")], "t")
    nothing = np.zeros(len(take), bool)
    seen = Seen(take.weights, measure(take.weights), take.fps, nothing, visemes=lane)
    (flag,) = [flag for flag in flags_of(seen) if flag.kind == "open"]
    assert (flag.start, flag.stop) == (wide - 1, wide + 2) and "where B is said" in flag.sentence
    shut = seen.controls.copy()
    shut[wide, LIPS] = CLOSED_MM / 2
    assert not [flag for flag in flags_of(replace(seen, controls=shut)) if flag.kind == "open"]


def test_lips_that_an_edit_parts_are_flagged_unless_that_was_asked() -> None:
    take = read_take(demo.BUNDLED)
    original = measure(take.weights)
    start, stop = next(
        run for run in runs(original[:, LIPS] < CLOSED_MM) if run[1] - run[0] < 8 and not take.lost[slice(*run)].any()
    )
    weights = take.weights.copy()
    weights[start:stop, JAW] += 0.5
    seen = Seen(weights, measure(weights), take.fps, take.lost, original_controls=original)
    opened = [flag for flag in flags_of(seen) if flag.kind == "open"]
    assert [(flag.start, flag.stop) for flag in opened] == [(start, stop)]
    asked = np.full_like(original, np.nan)
    asked[start:stop, LIPS] = seen.controls[start:stop, LIPS]
    assert not [flag for flag in flags_of(replace(seen, asked=asked)) if flag.kind == "open"]


def test_mouth_close_above_the_jaw_is_flagged() -> None:
    weights = still()
    weights[70:80, SHAPE_INDEX["mouthClose"]] = weights[70:80, JAW] + 0.3
    assert found(looked(weights), "close") == [(70, 80)]


def test_a_lip_that_leaves_the_teeth_is_flagged() -> None:
    weights = np.zeros((90, len(SHAPES)))
    weights[:, JAW] = 0.6
    lane = attached([Cue(1.0, 1.2, "F")], "t")
    assert found(looked(weights, visemes=lane), "teeth") == [(30, 36)]
    weights[32:34, JAW] = 0.0
    assert not found(looked(weights, visemes=lane), "teeth")


def mouth(lips_mm: Array, **more: object) -> Seen:
    """What is looked at of a mouth whose lips are so far apart."""
    controls = np.full((len(lips_mm), len(ALL_CONTROLS)), 30.0)
    controls[:, LIPS] = lips_mm
    weights = np.full((len(lips_mm), len(SHAPES)), 0.3)
    return replace(Seen(weights, controls, 30.0, np.zeros(len(lips_mm), bool)), **more)


@pytest.mark.parametrize(
    ("find", "label", "threshold", "full"), [(stay_open, "M", 2.0, 8.0), (off_teeth, "V", 8.0, 20.0)]
)
def test_the_nearest_that_lips_come_while_a_phone_is_said_counts(
    find, label: str, threshold: float, full: float
) -> None:
    lane = attached([Cue(0.5, 0.7, label), Cue(0.9, 1.0, "AA1"), Cue(1.2, 1.21, label), Cue(1.9, 9.0, label)], "t")
    lips = np.full(60, 25.0)
    lips[18], lips[36], lips[58] = threshold + (full - threshold) / 2, threshold, threshold - 0.1
    flags = list(find(mouth(lips, visemes=lane), 0, 60))
    assert [(flag.start, flag.stop, flag.weight) for flag in flags] == [(15, 21, pytest.approx(0.6))]
    assert f"{lips[18]:.1f} mm" in flags[0].sentence and f"where {label} is said" in flags[0].sentence
    lips[36] = threshold + 0.1
    assert [(flag.start, flag.stop) for flag in find(mouth(lips, visemes=lane), 0, 60)] == [(15, 21), (36, 37)]


def test_cues_beyond_the_take_say_nothing_of_it() -> None:
    lane = attached([Cue(-1.0, -0.5, "M"), Cue(2.5, 3.0, "M")], "t")
    assert not list(stay_open(mouth(np.full(60, 25.0), visemes=lane), 0, 60))
    assert not list(stay_open(mouth(np.full(60, 25.0)), 0, 60))


@pytest.mark.parametrize(("frames", "flagged"), [(7, True), (8, False)])
def test_lips_that_met_briefly_before_the_edits_should_still_meet(frames: int, flagged: bool) -> None:
    before = np.full(60, 20.0)
    before[20 : 20 + frames] = 1.0
    now = np.full(60, 5.0)
    seen = mouth(now, original_controls=mouth(before).controls)
    assert [(flag.start, flag.stop, flag.weight) for flag in stay_open(seen, 0, 60)] == [
        (20, 20 + frames, pytest.approx(0.6))
    ] * flagged
    met = now.copy()
    met[22] = 2.0
    assert not list(stay_open(replace(seen, controls=mouth(met).controls), 0, 60))
    for touched in (20, 20 + frames - 1):
        asked = np.where((np.arange(60) == touched)[:, None], seen.controls, np.nan)
        assert not list(stay_open(replace(seen, asked=asked), 0, 60))
        assert not list(stay_open(replace(seen, lost=np.arange(60) == touched), 0, 60))
    for beside in (19, 20 + frames):
        asked = np.where((np.arange(60) == beside)[:, None], seen.controls, np.nan)
        assert bool(list(stay_open(replace(seen, asked=asked), 0, 60))) == flagged


@pytest.mark.parametrize(("beyond", "jaw", "flagged"), [(0.09, 0.3, True), (0.07, 0.3, False), (0.09, -0.4, False)])
def test_mouth_close_counts_beyond_a_jaw_that_is_no_less_than_shut(beyond: float, jaw: float, flagged: bool) -> None:
    seen = mouth(np.full(30, 9.0))
    weights = seen.weights.copy()
    weights[:, JAW], weights[:, SHAPE_INDEX["mouthClose"]] = jaw, 0.0
    weights[10:14, SHAPE_INDEX["mouthClose"]] = jaw + beyond
    flags = list(close_above_jaw(replace(seen, weights=weights), 0, 30))
    assert [(flag.start, flag.stop) for flag in flags] == [(10, 14)] * flagged
    assert not list(close_above_jaw(replace(seen, weights=weights, lost=np.ones(30, bool)), 0, 30))
    half = replace(seen, weights=np.where(np.arange(len(SHAPES)) == SHAPE_INDEX["mouthClose"], jaw + 0.29, weights))
    if jaw > 0:
        assert [flag.weight for flag in close_above_jaw(half, 0, 30)] == [pytest.approx(0.6)]
