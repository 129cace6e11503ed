from __future__ import annotations

import numpy as np
import pytest

from engine.models.resample import from_model_rate, interpolate, model_frames, to_model_rate
from engine.take import SHAPES, Take

RNG = np.random.default_rng(0)


def take(fps: float, frames: int = 90) -> Take:
    return Take(RNG.random((frames, len(SHAPES))), fps, np.isin(np.arange(frames), [20, 21, 60]))


def test_between_frames_curves_are_straight_and_beyond_their_ends_they_are_held() -> None:
    curves = RNG.random((10, 3))
    at = np.array([-3.0, 0.0, 0.25, 4.5, 8.99, 9.0, 40.0])
    plain = np.stack([np.interp(at, np.arange(10), column) for column in curves.T], axis=1)
    np.testing.assert_allclose(interpolate(curves, at), plain, atol=1e-12)
    np.testing.assert_array_equal(interpolate(curves[:1], at), np.repeat(curves[:1], 7, axis=0))


@pytest.mark.parametrize(("fps", "frames"), [(60.0, 46), (25.0, 108), (120.0, 24), (59.94, 46), (30.0, 90)])
def test_a_take_has_frames_at_the_model_rate_up_to_its_last(fps: float, frames: int) -> None:
    one = take(fps)
    assert model_frames(one) == frames
    weights, lost = to_model_rate(one)
    assert weights.shape == (frames, len(SHAPES)) and lost.shape == (frames,)
    for frame in range(frames):
        at = min(frame * fps / 30, 89.0)
        before, after = int(np.floor(at)), int(np.ceil(at))
        np.testing.assert_allclose(
            weights[frame], one.weights[before] + (at - before) * (one.weights[after] - one.weights[before]), atol=1e-12
        )
        near = {before, after} if at % 1 else {before}
        assert lost[frame] == any(one.lost[beside] for beside in near)


def test_at_the_model_rate_nothing_is_changed() -> None:
    one = take(30.0)
    weights, lost = to_model_rate(one)
    assert weights is one.weights and lost is one.lost and from_model_rate(weights, one) is weights


def test_a_straight_change_comes_back_to_the_take_s_own_frames() -> None:
    one = take(60.0)
    change = np.arange(46.0)[:, None] * np.ones(len(SHAPES))
    np.testing.assert_allclose(from_model_rate(change, one), np.arange(90.0)[:, None] / 2 * np.ones(len(SHAPES)))
