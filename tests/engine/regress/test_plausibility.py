from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

from engine.controls import ALL_CONTROLS
from engine.extended import bundled_face
from engine.regress.plausibility import Plausible
from engine.regress.prior import bundled_prior
from engine.take import SHAPES, Array

COUNT = len(ALL_CONTROLS)
REST = np.repeat(bundled_face().measure(np.zeros((1, len(SHAPES)))), 40, axis=0)
PRIOR = bundled_prior()
SPAN = PRIOR.high - PRIOR.low


def granted(by: Array, *, own: Array = REST, takes: Array = REST, believability: float = 0.5) -> Array:
    """Return what is granted of a change, (16,) and NaN where nothing is asked, over all frames."""
    return Plausible(takes, PRIOR).granted(own + by, own, believability=believability, fps=30.0)


def asking(column: int, by: float) -> Array:
    wish = np.full(COUNT, np.nan)
    wish[column] = by
    return wish


@settings(deadline=None, max_examples=40)
@given(column=st.integers(0, COUNT - 1), share=st.floats(-3, 3), more=st.floats(1, 3))
def test_more_is_never_less_and_twice_is_once(column: int, share: float, more: float) -> None:
    less, further = (granted(asking(column, share * SPAN[column] * times))[:, column] for times in (1.0, more))
    assert (np.sign(share) * (further - less) >= -1e-9).all()
    own = REST.copy()
    own[:, column] = less
    again = Plausible(own, PRIOR).granted(REST + asking(column, share * SPAN[column]), own, believability=0.5, fps=30.0)
    np.testing.assert_allclose(again[:, column], less, rtol=0, atol=1e-9)


@pytest.mark.parametrize("column", range(COUNT))
def test_what_was_recorded_is_granted_and_little_beyond_it(column: int) -> None:
    for end in (PRIOR.low, PRIOR.high):
        wish = np.full(COUNT, np.nan)
        wish[column] = end[column] - REST[0, column]
        np.testing.assert_allclose(granted(wish)[:, column], end[column])
        np.testing.assert_allclose(granted(3 * wish, believability=1.0)[:, column], end[column], atol=1e-6)
        beyond = np.abs(granted(10 * wish)[:, column] - end[column])
        assert (beyond <= 0.25 * SPAN[column] + 1e-9).all()
        np.testing.assert_array_equal(granted(3 * wish, believability=0.0), REST + 3 * wish)


def test_what_the_take_does_is_granted() -> None:
    takes = REST.copy()
    takes[5, 0] = PRIOR.high[0] + 2 * SPAN[0]
    np.testing.assert_allclose(granted(asking(0, takes[5, 0] - REST[0, 0]), takes=takes)[:, 0], takes[5, 0])


def test_curves_that_do_not_go_together_are_drawn_back_together() -> None:
    apart = np.full(COUNT, np.nan)
    apart[[0, 1, 4, 5, 6, 7]] = [40.0, 15.0, -12.0, 15.0, -10.0, -12.0]
    drawn = granted(apart, believability=1.0)
    shares = (drawn - REST)[20] / apart
    assert np.nanmax(shares) < 0.9 and np.nanmin(shares) >= 0.0


def test_all_curves_of_the_mouth_doubled_are_drawn_back_further_than_three_are() -> None:
    """As many leave the face no way to follow: they are held to what most faces do."""
    mouth = [0, 1, 4, 5, 6, 7]
    faces = PRIOR.faces[:, mouth]
    far = PRIOR.faces[np.argsort(np.linalg.norm(faces - faces.mean(axis=0), axis=1))[-50:]]
    shares = []
    for columns in (mouth[:3], mouth):
        wish = np.full((len(far), COUNT), np.nan)
        wish[:, columns] = 2 * (far - REST[0])[:, columns]
        own = np.repeat(REST[:1], len(far), axis=0)
        given = Plausible(own, PRIOR).granted(own + wish, own, believability=0.5, fps=30.0) - own
        shares.append(np.linalg.norm(given[:, mouth[:3]]) / np.linalg.norm(wish[:, mouth[:3]]))
    assert shares[1] < 0.8 * shares[0]


def test_a_spike_is_drawn_back_and_a_step_is_not() -> None:
    spike, step = np.full((40, COUNT), np.nan), np.full((40, COUNT), np.nan)
    spike[:, 6] = step[:, 6] = 0.0
    spike[20, 6] = 6.0
    step[10:30, 6] = 6.0
    assert granted(spike)[20, 6] - REST[20, 6] < 4.0
    assert granted(step)[20, 6] - REST[20, 6] == pytest.approx(6.0)


def test_spikes_in_many_curves_are_noise_and_a_blink_beside_a_smile_is_not() -> None:
    """However many curves are asked for: it is the spikes that count."""
    lids, smile = [2, 3], [4, 5, 1]
    blink = np.full((60, COUNT), np.nan)
    blink[:, lids] = blink[:, smile] = 0.0
    blink[30, lids] = -3.0
    own = np.repeat(REST[:1], 60, axis=0)
    alone = np.where(np.isin(np.arange(COUNT), lids), blink, np.nan)
    given, lonely = (Plausible(own, PRIOR).granted(own + by, own, believability=0.5, fps=30.0) for by in (blink, alone))
    np.testing.assert_allclose(given[30, lids], lonely[30, lids])
    assert (REST[0] - given[30])[lids].min() > 2.9
    salt = np.zeros((60, COUNT)) + np.where(np.arange(COUNT) < 8, 0.0, np.nan)
    salt[::4, :8] = 10.0
    noise = Plausible(own, PRIOR).granted(own + salt, own, believability=0.5, fps=30.0) - own
    assert np.nanmax(np.abs(noise[28])) < 4.0


@pytest.mark.parametrize("fps", [30.0, 120.0])
def test_all_curves_asked_again_stay_where_they_are(fps: float) -> None:
    """To a fifth: what lies about a frame that is drawn back is drawn back with it, and may come a little after."""
    columns = np.arange(COUNT) < 8
    rows = CubicSpline(np.arange(12), PRIOR.faces[::100][:12])(np.arange(0, 11, 3 / fps))
    wish = np.where(columns, rows + 2 * (rows - REST[0]), np.nan)
    once = Plausible(rows, PRIOR).granted(wish, rows, believability=0.5, fps=fps)
    there = np.where(columns, once, rows)
    twice = Plausible(rows, PRIOR).granted(wish, there, believability=0.5, fps=fps)
    moved = np.abs(once - rows)[:, columns].mean()
    assert np.abs(twice - once)[:, columns].mean() <= 0.2 * moved


def test_beside_many_curves_of_the_mouth_lips_stay_as_they_are() -> None:
    """As a paste of a whole mouth has it whose lips were shut already: nothing asked them to open."""
    own = np.repeat(REST[:1], 60, axis=0)
    wish = np.full((60, COUNT), np.nan)
    wish[10:50, [1, 4, 5, 6, 7]] = own[10:50, [1, 4, 5, 6, 7]] + 3.0
    many = Plausible(own, PRIOR).granted(wish, own, believability=0.5, fps=30.0)
    np.testing.assert_array_equal(many[:, 0], own[:, 0])
    wish[:, 7] = np.nan
    assert np.isnan(Plausible(own, PRIOR).granted(wish, own, believability=0.5, fps=30.0)[:, 0]).all()
