from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from engine.take import SHAPES, Take, runs


def a_take(seed: int, frames: int = 40) -> Take:
    """Return a take whose lost frames lie on straight lines, as every reader leaves them."""
    rng = np.random.default_rng(seed)
    lost = rng.random(frames) < 0.4
    lost[rng.integers(0, frames)] = False
    known = np.flatnonzero(~lost)
    curves = rng.random((len(known), len(SHAPES)))
    weights = np.stack([np.interp(np.arange(frames), known, curve) for curve in curves.T], axis=1)
    return Take(weights, 30.0, lost)


def straight(take: Take) -> np.ndarray:
    known = np.flatnonzero(~take.lost)
    return np.stack([np.interp(np.arange(len(take)), known, curve) for curve in take.weights[known].T], axis=1)


@given(st.integers(0, 10_000), st.data())
def test_lost_frames_lie_between_their_neighbours_whatever_is_put_where(seed: int, data: st.DataObject) -> None:
    take = a_take(seed)
    start = data.draw(st.integers(0, len(take) - 1))
    stop = data.draw(st.integers(start + 1, len(take)))
    rng = np.random.default_rng(seed + 1)
    rows = take.weights[start:stop].copy()
    changed = rng.random(stop - start) < 0.6
    rows[changed] += rng.random((int(changed.sum()), 1))
    edited = take.with_rows(start, rows)

    inside = np.zeros(len(take), bool)
    inside[start:stop] = changed
    np.testing.assert_array_equal(edited.lost, take.lost & ~inside)
    np.testing.assert_array_equal(edited.weights[inside], rows[changed])
    if not edited.lost.all():
        np.testing.assert_allclose(edited.weights, straight(edited), atol=1e-12)
    first, last = take.with_lost_beside(start, stop)
    outside = np.r_[0:first, last : len(take)]
    np.testing.assert_array_equal(edited.weights[outside], take.weights[outside])
    known = ~take.lost & ~inside
    np.testing.assert_array_equal(edited.weights[known], take.weights[known])


@given(st.integers(0, 10_000))
def test_putting_the_same_back_changes_nothing(seed: int) -> None:
    take = a_take(seed)
    again = take.with_weights(take.weights)
    np.testing.assert_array_equal(again.weights, take.weights)
    np.testing.assert_array_equal(again.lost, take.lost)


def test_frames_that_are_found_are_not_lost_even_where_they_do_not_move() -> None:
    take = a_take(3)
    start, stop = runs(take.lost)[0]
    found = take.with_rows(start, take.weights[start:stop], found=np.ones(stop - start, bool))
    assert not found.lost[start:stop].any()
    np.testing.assert_array_equal(found.weights, take.weights)
    np.testing.assert_array_equal(found.lost[stop:], take.lost[stop:])


@pytest.mark.parametrize("seed", range(5))
def test_exact_rows_are_put_back_to_the_bit(seed: int) -> None:
    take = a_take(seed)
    edited = take.with_rows(10, take.weights[10:20] * 0.5)
    first, last = take.with_lost_beside(10, 20)
    back = edited.with_exact_rows(first, take.weights[first:last], take.lost[first:last])
    np.testing.assert_array_equal(back.weights, take.weights)
    np.testing.assert_array_equal(back.lost, take.lost)
