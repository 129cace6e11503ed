from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.anatomy import EXCLUSIVE, pairs
from engine.quality import KINDS, MISSED_MM, TUNING, Seen, flags_after, flags_of
from engine.take import SHAPES, runs
from tests.engine.quality.takes import EVERY, measure, troubled, with_weights

WHOLE = {"swapped", "unblinking", "short", "sound"}  # need a longer take, or sound: each has a test of its own


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 20), st.integers(0, 418), st.integers(1, 30), st.sampled_from(["still", "noise", "jump", "lost"]))
def test_looking_again_near_an_edit_finds_what_looking_at_everything_does(
    seed: int, start: int, length: int, edit: str
) -> None:
    before = troubled(seed)
    flags = flags_of(before, EVERY)
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
    assert flags_after(flags, after, (start, stop), EVERY) == flags_of(after, EVERY)


def test_a_troubled_take_has_every_kind_of_flag_and_each_is_told() -> None:
    found = [flag for seed in range(8) for flag in flags_of(troubled(seed), EVERY)]
    assert {flag.kind for flag in found} == set(KINDS) - WHOLE
    assert all(flag.start < flag.stop and 0 < flag.weight <= 1 and flag.sentence.endswith(".") for flag in found)


def test_each_kind_is_where_a_plain_rule_says() -> None:
    seen = troubled(3)
    frames = range(len(seen.weights))
    found = {kind: [(f.start, f.stop) for f in flags_of(seen) if f.kind == kind] for kind in KINDS}
    assert found["lost"] == runs(seen.lost)
    wide = np.array([EXCLUSIVE[row][1] == "mouthStretch" for *_, row in pairs()])
    both = np.array([np.minimum(seen.weights[:, a], seen.weights[:, b]) for a, b, _ in pairs()])
    assert found["impossible"] == runs((both > np.where(wide, TUNING.both_wide, TUNING.both)[:, None]).any(axis=0))
    most = np.array([TUNING.most_gaze if name.startswith("eyeLook") else TUNING.most_weight for name in SHAPES])
    beyond = (seen.weights < TUNING.least_weight) | (seen.weights > most)
    assert found["range"] == runs(beyond.any(axis=1) & ~seen.lost)
    same = [
        i > 0 and not seen.lost[i - 1 : i + 1].any() and (seen.weights[i] == seen.weights[i - 1]).all() for i in frames
    ]
    assert found["frozen"] == [run for run in runs(np.array(same)) if run[1] - run[0] >= 5]  # .15 s at 30 fps
    for start, stop in found["missed"]:
        away = np.abs(seen.asked[start:stop] - seen.controls[start:stop])
        assert (away > MISSED_MM).all(axis=0).any()


@pytest.mark.parametrize("frames", [1, 2, 3])
def test_the_shortest_takes_are_looked_at(frames: int) -> None:
    weights = np.zeros((frames, len(SHAPES)))
    seen = Seen(weights, measure(weights), 30.0, np.zeros(frames, bool))
    assert all(flag.kind == "frozen" for flag in flags_of(seen))
