from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.curves.brush import eased_to, falloff, pulled, reach
from app.curves.tools.scale import scaled_in_time

CURVES = st.lists(st.floats(0, 60), min_size=1, max_size=60).map(np.array)
PULLS, RADII = st.floats(-100, 100), st.floats(0.1, 40)


def bent(curve: np.ndarray, centre: int, *, by: float, radius: float, **limits: float) -> np.ndarray:
    start, stop = reach(centre, radius, len(curve))
    rows = pulled(curve[start:stop], start, centre, by=by, radius_frames=radius, strength=1.0, **limits)
    return np.concatenate([curve[:start], rows, curve[stop:]])


@given(st.integers(0, 50), st.floats(0.1, 40))
def test_the_brush_moves_only_its_reach(centre: int, radius: float) -> None:
    start, stop = reach(centre, radius, 51)
    follows = falloff(np.arange(51.0), centre, radius)
    assert follows[centre] == 1.0
    assert (follows[:start] == 0).all() and (follows[stop:] == 0).all()


@given(CURVES, st.data(), PULLS, RADII)
def test_a_pull_goes_one_way_and_never_through_the_floor(
    curve: np.ndarray, data: st.DataObject, by: float, radius: float
) -> None:
    centre = data.draw(st.integers(0, len(curve) - 1))
    after = bent(curve, centre, by=by, radius=radius)
    moved = after - curve
    assert (after >= -1e-12).all() and (np.sign(by) * moved >= -1e-12).all()
    assert (np.abs(moved) <= abs(by) + 1e-9).all()
    assert after[centre] == pytest.approx(max(0.0, curve[centre] + by), abs=1e-9)


@given(CURVES, st.data(), PULLS, st.floats(1.0, 3.0), RADII)
def test_pulling_further_never_moves_less(
    curve: np.ndarray, data: st.DataObject, by: float, times: float, radius: float
) -> None:
    centre = data.draw(st.integers(0, len(curve) - 1))
    less, more = (bent(curve, centre, by=each, radius=radius) - curve for each in (by, times * by))
    assert (np.abs(more) >= np.abs(less) - 1e-9).all()


@given(st.floats(4, 30), st.floats(0.5, 3.5), st.floats(1.0, 4.0), st.floats(0.2, 1.5))
def test_a_peak_that_is_pulled_down_leaves_no_needle(high: float, base: float, width: float, share: float) -> None:
    frame = np.arange(61.0)
    curve = base + (high - base) * np.exp(-(((frame - 30) / width) ** 2))
    after = bent(curve, 30, by=-share * high, radius=15.0)
    beside = after[[26 - int(width), 34 + int(width)]].min()
    assert after[30] <= max(0.0, (1 - share) * high) + 1e-9
    # the peak stands over what is beside it no higher than before, in proportion
    stood, stands = high / curve[[26 - int(width), 34 + int(width)]].min(), after[30] / max(beside, 1e-12)
    assert stands <= stood + 1e-6


@given(CURVES.map(lambda curve: curve / 60), st.data(), st.floats(-2, 2), RADII)
def test_a_weight_stays_between_nothing_and_all(
    curve: np.ndarray, data: st.DataObject, by: float, radius: float
) -> None:
    centre = data.draw(st.integers(0, len(curve) - 1))
    after = bent(curve, centre, by=by, radius=radius, floor=0.0, ceiling=1.0)
    assert (after >= -1e-12).all() and (after <= 1 + 1e-12).all()
    assert after[centre] == pytest.approx(np.clip(curve[centre] + by, 0, 1), abs=1e-9)


@given(CURVES, st.data(), st.floats(0, 60), st.floats(0, 20), st.floats(0, 20))
def test_what_is_eased_never_overshoots_and_has_soft_ends(
    curve: np.ndarray, data: st.DataObject, value: float, before: float, after: float
) -> None:
    start = data.draw(st.integers(0, len(curve) - 1))
    stop = data.draw(st.integers(start + 1, len(curve)))
    first, rows = eased_to(curve, (start, stop), value, before_frames=before, after_frames=after)
    there = curve[first : first + len(rows)]
    assert (rows >= np.minimum(there, value) - 1e-9).all() and (rows <= np.maximum(there, value) + 1e-9).all()
    np.testing.assert_array_equal(rows[start - first : stop - first], value)
    assert start - first <= np.ceil(before) and first + len(rows) - stop <= np.ceil(after)


@pytest.mark.parametrize("fps", [24, 30, 60, 120])
def test_an_ease_lasts_as_long_at_every_rate(fps: int) -> None:
    curve = np.full(3 * fps, 10.0)
    first, rows = eased_to(curve, (fps, fps + 1), 0.0, before_frames=0.08 * fps, after_frames=0.14 * fps)
    at = (first + np.arange(len(rows)) - fps) / fps
    inside = rows < 10.0 - 1e-9
    assert at[inside].min() > -0.08 and at[inside].max() < 0.14
    assert at[inside].min() < -0.08 + 1.01 / fps and at[inside].max() > 0.14 - 1.01 / fps
    half = np.interp([-0.04, 0.07], at, rows)
    np.testing.assert_allclose(half, 5.0, atol=1.3)


@given(CURVES.filter(lambda curve: len(curve) > 6), st.data())
def test_a_stretch_that_is_made_longer_or_shorter_stays_within_what_was_there(
    curve: np.ndarray, data: st.DataObject
) -> None:
    start = data.draw(st.integers(0, len(curve) - 4))
    stop = data.draw(st.integers(start + 2, len(curve)))
    new_stop = data.draw(st.integers(start + 2, len(curve)))
    first, rows = scaled_in_time(curve, start, stop, new_stop, join_frames=4.5)
    assert first == start and start + len(rows) <= len(curve)
    assert rows.min() >= curve.min() - 1e-9 and rows.max() <= curve.max() + 1e-9
    np.testing.assert_allclose(rows[0], curve[start])


@given(st.floats(0, 5), st.floats(0, 40), RADII, st.sampled_from([(), (50.0,)]))
def test_what_is_pulled_up_and_back_is_as_it_was(
    rest: float, by: float, radius: float, ceiling: tuple[float, ...]
) -> None:
    limits = {"ceiling": ceiling[0]} if ceiling else {}
    curve = np.full(81, rest)
    up = bent(curve, 40, by=by, radius=radius, **limits)
    back = bent(up, 40, by=-by, radius=radius, **limits)
    np.testing.assert_allclose(back, curve, atol=1e-9)
