from __future__ import annotations

import numpy as np
import pytest

from engine.inpaint.seams import binomial_smooth, bridge, bridge_weights, constrain, distance_frames, nearest_known


def plain_bridge(curve: np.ndarray, reach: float, hold: np.ndarray) -> np.ndarray:
    """The same minimum by a dense solve of the assembled system."""
    first, second = np.diff(np.eye(len(curve)), axis=0), np.diff(np.eye(len(curve)), 2, axis=0)
    system = first.T @ first / reach**2 + second.T @ second + np.diag(hold + 1e-9)
    free, curves = np.isnan(curve), np.nan_to_num(curve)
    curves[free] = np.linalg.solve(system[np.ix_(free, free)], -(system @ curves)[free])
    return curves


@pytest.fixture
def known() -> np.ndarray:
    rng = np.random.default_rng(0)
    curves = rng.random((40, 6))
    curves[5:9, 0] = np.nan
    curves[5:30, 1] = curves[5:30, 2] = np.nan
    curves[12, 2] = 0.5  # a pin on one shape alone
    curves[:25, 3] = np.nan  # from the take's first frame
    curves[38:, 4] = np.nan
    return curves


@pytest.mark.parametrize("reach", [1.0, 4.0, 100.0])
def test_equals_a_dense_solve(known: np.ndarray, reach: float) -> None:
    hold = np.random.default_rng(1).random(len(known))
    curves = bridge(known, reach_frames=reach, hold=hold)
    for column, curve in enumerate(known.T):
        np.testing.assert_allclose(curves[:, column], plain_bridge(curve, reach, hold), atol=1e-10)


def test_known_values_stay_to_the_last_bit(known: np.ndarray) -> None:
    curves = bridge(known)
    there = np.isfinite(known)
    np.testing.assert_array_equal(curves[there], known[there])
    assert np.isfinite(curves).all()


def test_a_short_hole_in_a_cubic_comes_back_whole() -> None:
    at = np.arange(30.0)
    cubic = 1e-4 * (at - 9) ** 3 - 0.01 * at
    holed = np.where((at >= 12) & (at < 18), np.nan, cubic)[:, None]
    np.testing.assert_allclose(bridge(holed, reach_frames=1e4)[:, 0], cubic, atol=2e-3)


def test_the_correction_moves_motion_onto_what_is_known_and_leaves_the_rest_nearly_alone(known: np.ndarray) -> None:
    motion = np.random.default_rng(2).random(known.shape)
    constrained = constrain(motion, known)
    there = np.isfinite(known)
    np.testing.assert_allclose(constrained[there], known[there], atol=1e-12)
    np.testing.assert_allclose(constrain(np.nan_to_num(known, nan=0.3), np.where(there, known, np.nan))[~there], 0.3)


def test_a_frame_with_a_pull_is_corrected_less() -> None:
    motion, known = np.full((40, 1), 0.5), np.full((40, 1), np.nan)
    known[:2] = known[38:] = 0.8
    hold = np.zeros(40)
    hold[6] = 10.0
    assert abs(constrain(motion, known, hold=hold)[6, 0] - 0.5) < 0.1 * abs(constrain(motion, known)[6, 0] - 0.5)


def test_distances_count_frames_to_the_nearest_known_value(known: np.ndarray) -> None:
    there = [np.flatnonzero(np.isfinite(curve)) for curve in known.T]
    expected = np.array([[np.abs(frame - at).min() for at in there] for frame in range(len(known))])
    np.testing.assert_array_equal(distance_frames(known), expected)


def test_a_bridge_of_weights_stays_in_range_where_slopes_overshoot() -> None:
    known = np.concatenate([np.linspace(0.4, 0.02, 10), np.full(10, np.nan), np.linspace(0.02, 0.4, 10)])[:, None]
    assert bridge(known).min() < -0.01
    curves = bridge_weights(known)
    assert curves.min() >= 0 and np.array_equal(curves[np.isfinite(known)], known[np.isfinite(known)])


def test_distances_equal_a_plain_search(known: np.ndarray) -> None:
    for column, curve in enumerate(known.T):
        there = np.flatnonzero(np.isfinite(curve))
        plain = [np.abs(there - frame).min() for frame in range(len(curve))]
        np.testing.assert_array_equal(distance_frames(known)[:, column], plain)


def test_the_nearest_known_frame_counts_unknown_shapes_alone(known: np.ndarray) -> None:
    plain = []
    for frame in range(len(known)):
        away = [np.abs(np.flatnonzero(np.isfinite(c)) - frame).min() for c in known.T if np.isnan(c[frame])]
        plain.append(min(away, default=0))
    np.testing.assert_array_equal(nearest_known(known), plain)


def test_binomial_smoothing_is_a_plain_convolution_inside(known: np.ndarray) -> None:
    curve = np.random.default_rng(0).random((20, 1))
    plain = np.convolve(curve[:, 0], np.array([1, 4, 6, 4, 1]) / 16, mode="valid")
    np.testing.assert_allclose(binomial_smooth(curve, 2)[2:-2, 0], plain, atol=1e-12)
