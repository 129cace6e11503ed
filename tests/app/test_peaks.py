from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.curves.brush import falloff, pulled, reach
from app.curves.peaks import on_screen, peaks


@given(st.integers(1, 5000), st.integers(1, 400), st.integers(0, 1000))
def test_no_extreme_is_lost_and_the_cost_is_bounded(frames: int, columns: int, start: int) -> None:
    curve = np.random.default_rng(frames).standard_normal(frames)
    x, y = peaks(curve, start, columns)
    assert len(x) == len(y) <= max(3 * columns + 3, 2 * (columns + 2) * 2)
    assert y.max() == curve.max() and y.min() == curve.min()
    assert (np.diff(x) >= 0).all()


def test_a_view_shows_one_frame_more_on_either_side() -> None:
    assert on_screen(100, (10.0, 20.0)) == (9, 22)
    assert on_screen(15, (0.0, 14.0)) == (0, 15)


@given(st.integers(0, 50), st.integers(1, 40))
def test_the_brush_moves_only_its_reach(centre: int, radius: int) -> None:
    start, stop = reach(centre, radius, 51)
    follows = falloff(np.arange(51.0), centre, radius)
    assert follows[centre] == 1.0
    assert (follows[:start] == 0).all() and (follows[stop:] == 0).all()
    curve = np.full(stop - start, 5.0)
    lowered = pulled(curve, start, centre, by=-20.0, radius_frames=radius, strength=1.0)
    assert lowered.min() == 0.0 and (lowered <= curve).all()
