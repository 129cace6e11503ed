from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.anatomy import BOTH, impossible
from engine.controls import CONTROL_INDEX, measure
from engine.formats import read_take
from engine.performance import demo
from engine.quality import CLOSED_MM, KINDS, MISSED_MM, Seen, flags_after, flags_of, leaps, repeats, seen_of
from engine.speech.lane import attached
from engine.speech.visemes import Cue
from engine.take import SHAPE_INDEX, SHAPES, Array, runs

LIPS, JAW = CONTROL_INDEX["lips_vertical"], SHAPE_INDEX["jawOpen"]


def troubled(seed: int, frames: int = 120) -> Seen:
    """A slow random performance with every fault in it."""
    rng = np.random.default_rng(seed)
    knots = rng.random((frames // 12 + 2, len(SHAPES))) * rng.random(len(SHAPES))
    at = np.linspace(0, len(knots) - 1.001, frames)
    low = at.astype(int)
    weights = knots[low] + (at - low)[:, None] * (knots[low + 1] - knots[low])
    weights[rng.integers(1, frames - 1, 4), rng.integers(0, len(SHAPES), 4)] += 0.5
    for start in rng.integers(0, frames - 9, 3):
        weights[start : start + rng.integers(2, 8)] = weights[start]
    lost = np.zeros(frames, bool)
    lost[frames // 2 : frames // 2 + 5] = True
    original = measure(np.clip(weights - rng.random(weights.shape) * 0.4, 0, 1))
    cues = [Cue(start, start + 0.1, label) for start, label in zip(rng.random(12) * 4, "MABPIMVBOMPB", strict=True)]
    return with_weights(Seen(weights, measure(weights), 30.0, lost, None, original, attached(cues, "t")), weights)


def with_weights(seen: Seen, weights: Array) -> Seen:
    controls = measure(weights)
    asked = np.where(np.arange(len(weights))[:, None] % 40 < 9, controls + np.sin(np.arange(8)) * 4, np.nan)
    return replace(seen, weights=weights, controls=controls, asked=asked)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 20), st.integers(0, 118), st.integers(1, 30), st.sampled_from(["still", "noise", "jump", "lost"]))
def test_looking_again_near_an_edit_finds_what_looking_at_everything_does(
    seed: int, start: int, length: int, edit: str
) -> None:
    before = troubled(seed)
    flags = flags_of(before)
    stop = min(len(before.weights), start + length)
    weights, lost = before.weights.copy(), before.lost.copy()
    if edit == "still":
        weights[start:stop] = weights[max(0, start - 1)]
    elif edit == "noise":
        weights[start:stop] = np.random.default_rng(seed).random((stop - start, len(SHAPES)))
    elif edit == "jump":
        weights[start:stop] += 0.4
    else:
        lost[start:stop] ^= True
    after = with_weights(replace(before, lost=lost), weights)
    assert flags_after(flags, after, (start, stop)) == flags_of(after)


def test_a_troubled_take_has_every_kind_of_flag_and_each_is_told() -> None:
    found = [flag for seed in range(8) for flag in flags_of(troubled(seed))]
    assert {flag.kind for flag in found} == set(KINDS)
    assert all(flag.start < flag.stop and 0 < flag.weight <= 1 and flag.sentence.endswith(".") for flag in found)


def test_each_kind_is_where_a_plain_rule_says() -> None:
    seen = troubled(3)
    frames = range(len(seen.weights))
    found = {kind: [(f.start, f.stop) for f in flags_of(seen) if f.kind == kind] for kind in KINDS}
    assert found["lost"] == runs(seen.lost)
    assert found["impossible"] == runs(impossible(seen.weights))
    same = [
        i > 0 and not seen.lost[i - 1 : i + 1].any() and (seen.weights[i] == seen.weights[i - 1]).all() for i in frames
    ]
    assert found["frozen"] == [run for run in runs(np.array(same)) if run[1] - run[0] >= 2]
    for start, stop in found["missed"]:
        away = np.abs(seen.asked[start:stop] - seen.controls[start:stop])
        assert (away > MISSED_MM).all(axis=0).any()
    assert BOTH < 0.5


def test_a_leap_that_returns_is_a_spike_and_one_that_stays_is_none() -> None:
    weights = np.tile(np.linspace(0, 0.2, 30)[:, None], (1, len(SHAPES)))
    kept = np.ones(30, bool)
    assert not leaps(weights, kept).any()
    weights[10, JAW] += 0.3
    assert np.flatnonzero(leaps(weights, kept)).tolist() == [10]
    kept[11] = False
    assert not leaps(weights, kept).any()
    weights[10:, JAW] += 0.3
    weights[10, JAW] -= 0.3
    assert not leaps(weights, np.ones(30, bool)).any()
    assert not repeats(weights, np.ones(30, bool)).any()


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


def test_a_lost_frame_that_was_filled_is_not_flagged() -> None:
    take = read_take(demo.BUNDLED)
    (start, stop), *_ = runs(take.lost)
    filled = take.with_rows(start, take.weights[start:stop] + 0.01)
    assert "lost" in {flag.kind for flag in flags_of(seen_of(take, take))}
    assert "lost" not in {flag.kind for flag in flags_of(seen_of(filled, take))}


@pytest.mark.parametrize("frames", [1, 2, 3])
def test_the_shortest_takes_are_looked_at(frames: int) -> None:
    weights = np.zeros((frames, len(SHAPES)))
    seen = Seen(weights, measure(weights), 30.0, np.zeros(frames, bool))
    assert all(flag.kind == "frozen" for flag in flags_of(seen))
