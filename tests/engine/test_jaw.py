from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from engine.controls import bundled_measurer
from engine.jaw import CLOSE, JAW, ahead, drawable, excess, follow, limited
from engine.take import SHAPES

weight = st.floats(-0.5, 1.5)


@given(weight, weight)
def test_the_lips_close_no_further_than_the_jaw_has_opened(jaw: float, close: float) -> None:
    weights = np.full((1, len(SHAPES)), 0.3)
    weights[0, JAW], weights[0, CLOSE] = jaw, close
    before = weights.copy()
    shown = limited(weights)
    assert shown[0, CLOSE] == min(close, max(jaw, 0.0)) and shown[0, JAW] == jaw
    np.testing.assert_array_equal(np.delete(shown, CLOSE, axis=1), np.delete(weights, CLOSE, axis=1))
    np.testing.assert_array_equal(weights, before)
    assert excess(weights)[0] == close - max(jaw, 0.0)
    assert ahead(weights)[0] == (close > jaw)
    np.testing.assert_array_equal(drawable(weights), limited(np.clip(weights, 0.0, 1.0)))
    np.testing.assert_array_equal(drawable(weights)[0], drawable(weights[0]))


def test_a_single_frame_keeps_its_kind_of_number() -> None:
    assert drawable(np.zeros(len(SHAPES), np.float32)).dtype == np.float32


@pytest.mark.parametrize(("jaw", "close"), [(0.2, 0.5), (0.5, 0.2)])
def test_slopes_follow_as_the_measured_controls_do(jaw: float, close: float) -> None:
    weights = np.full((1, len(SHAPES)), 0.1)
    weights[0, JAW], weights[0, CLOSE] = jaw, close
    measurer, step = bundled_measurer(), 1e-6
    slope = measurer.jacobian(weights)[0]
    for column in (JAW, CLOSE):
        near = [weights.copy(), weights.copy()]
        near[0][0, column] -= step
        near[1][0, column] += step
        measured = (measurer.measure(near[1]) - measurer.measure(near[0]))[0] / (2 * step)
        np.testing.assert_allclose(slope[:, column], measured, atol=1e-4)


def test_only_frames_whose_lips_are_ahead_follow() -> None:
    weights = np.zeros((2, len(SHAPES)))
    weights[:, JAW], weights[:, CLOSE] = 0.5, (0.6, 0.4)
    slopes = np.ones((2, 3, len(SHAPES)))
    follow(slopes, weights)
    assert (slopes[0, :, JAW] == 2).all() and (slopes[0, :, CLOSE] == 0).all()
    assert (slopes[1] == 1).all()
