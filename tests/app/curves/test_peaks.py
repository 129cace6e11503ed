from __future__ import annotations

import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.curves.line import _whole_parts
from app.curves.peaks import BLOCK, Thinned, on_screen, overlaid, peaks


@given(st.integers(1, 5000), st.integers(1, 400), st.integers(0, 1000))
def test_no_extreme_is_lost_and_the_cost_is_bounded(frames: int, columns: int, start: int) -> None:
    curve = np.random.default_rng(frames).standard_normal(frames)
    x, y = peaks(curve, start, columns)
    assert len(x) == len(y) <= max(3 * columns + 3, 2 * (columns + 2) * 2)
    assert y.max() == curve.max() and y.min() == curve.min()
    assert (np.diff(x) >= 0).all()


def test_a_thinned_curve_reaches_the_last_frame_and_none_beyond() -> None:
    frames = 40 * BLOCK + 1  # the last block has a frame alone
    curve = np.zeros(frames)
    curve[-1] = 99.0
    x, y = Thinned(curve).peaks(0, frames, 4)
    assert x[y == 99.0].max() == frames - 1 == x.max()


@given(st.integers(1, 9000), st.integers(1, 300), st.data())
def test_a_thinned_curve_keeps_every_extreme_where_it_was(frames: int, columns: int, data: st.DataObject) -> None:
    curve = np.random.default_rng(frames).standard_normal((frames, 3))[:, 1]
    start = data.draw(st.integers(0, frames - 1))
    stop = data.draw(st.integers(start + 1, frames))
    step = max(1, (stop - start) // columns)
    x, y = Thinned(curve).peaks(start, stop, columns)
    assert len(x) == len(y) <= max(3 * columns + 3, 4 * (columns + 3))
    assert (np.diff(x) >= 0).all() and x[0] >= start - step - BLOCK and x[-1] <= stop + step + BLOCK
    spiked = curve.copy()
    spike = data.draw(st.integers(start, stop - 1))
    spiked[spike] = 99.0
    x, y = Thinned(spiked).peaks(start, stop, columns)
    assert y.max() == 99.0 and np.abs(x[y == 99.0] - spike).max() <= step


@given(st.integers(1, 9000), st.integers(1, 300), st.data())
def test_a_draft_and_an_edit_are_drawn_as_if_the_curve_were_new(frames: int, columns: int, data: st.DataObject) -> None:
    rng = np.random.default_rng(frames)
    curve = rng.standard_normal(frames)
    at = data.draw(st.integers(0, frames - 1))
    rows = rng.standard_normal(data.draw(st.integers(1, frames - at))) * 9
    start = data.draw(st.integers(0, frames - 1))
    edited = overlaid(curve, 0, rows, at)
    wanted = Thinned(edited).peaks(start, frames, columns)
    thinned = Thinned(curve)
    np.testing.assert_array_equal(thinned.peaks(start, frames, columns, (rows, at)), wanted)
    thinned.changed_to(edited, (at, at + len(rows)))
    np.testing.assert_array_equal(thinned.peaks(start, frames, columns), wanted)
    assert thinned.stands_for(edited) and not thinned.stands_for(edited.copy())


@given(st.lists(st.booleans(), min_size=1, max_size=30))
def test_a_line_has_a_gap_wherever_there_is_no_value(gaps: list[bool]) -> None:
    parts = _whole_parts(np.where(gaps, np.nan, 1.0))
    drawn = [frame for part in parts for frame in range(part.start, part.stop)]
    assert drawn == [frame for frame, gap in enumerate(gaps) if not gap]
    assert all(later.start > part.stop for part, later in itertools.pairwise(parts))


def test_a_view_shows_one_frame_more_on_either_side() -> None:
    assert on_screen(100, (10.0, 20.0)) == (9, 22)
    assert on_screen(15, (0.0, 14.0)) == (0, 15)
