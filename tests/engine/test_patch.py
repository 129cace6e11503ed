"""A patch says of each of its frames what becomes of it; outside, nothing moves by a bit."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.errors import EditError
from engine.extended import bundled_face
from engine.patch import Patch
from engine.take import SHAPES, Take

FRAMES = 24


def a_take(seed: int, lost: list[bool]) -> Take:
    return Take(np.random.default_rng(seed).random((FRAMES, len(SHAPES))), 30.0, np.array(lost))


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 99),
    lost=st.lists(st.booleans(), min_size=FRAMES, max_size=FRAMES),
    start=st.integers(0, FRAMES - 2),
    length=st.integers(1, 6),
)
def test_the_patch_between_two_takes_turns_one_into_the_other(
    seed: int, lost: list[bool], start: int, length: int
) -> None:
    take, stop = a_take(seed, lost), min(FRAMES, start + length)
    after = take.with_rows(start, np.random.default_rng(seed + 1).random((stop - start, len(SHAPES))))
    patch = Patch.between(take, after, (start, stop))
    made = patch.apply(take)
    np.testing.assert_array_equal(made.weights, after.weights)
    np.testing.assert_array_equal(made.lost, after.lost)
    np.testing.assert_array_equal(patch.reached, bundled_face().measure(patch.weights))
    assert np.isnan(patch.asked).all() and patch.granted is None and patch.settled(take) is patch


def test_a_settled_patch_keeps_what_was_asked_and_grows_over_lost_frames_beside_it() -> None:
    lost = [False] * FRAMES
    lost[8] = lost[9] = True
    take = a_take(3, lost)
    rows = np.full((2, len(SHAPES)), 0.5)
    reached = bundled_face().measure(rows)
    asked = np.full_like(reached, np.nan)
    asked[:, 0] = 7.0
    settled = Patch(10, rows, asked, reached, granted=asked).settled(take)
    assert (settled.start, settled.stop) == (8, 12) and settled.lost is not None
    np.testing.assert_array_equal(settled.lost, [True, True, False, False])
    np.testing.assert_array_equal(settled.asked[2:], asked)
    assert np.isnan(settled.asked[:2]).all() and settled.granted is not None
    np.testing.assert_array_equal(settled.granted[2:], asked)
    np.testing.assert_array_equal(settled.apply(take).weights, Patch(10, rows, asked, reached).apply(take).weights)


def test_takes_of_two_lengths_have_no_patch_between_them() -> None:
    take = a_take(1, [False] * FRAMES)
    with pytest.raises(EditError, match="12 frames, the take 24"):
        Patch.between(take, Take(take.weights[:12], 30.0), (0, 12))
