from __future__ import annotations

import numpy as np

from engine.controls import CONTROL_INDEX, measure
from engine.inpaint.statistics import TUNING, Statistics, regress_controls, regression
from engine.take import SHAPES, Array
from tests.engine.inpaint.gaps import SPAN


def test_the_statistics_are_the_plain_moments(truth: Array, statistics: Statistics) -> None:
    both = np.cov(np.hstack([measure(truth), truth]).T, bias=True)
    controls = len(CONTROL_INDEX)
    np.testing.assert_allclose(statistics.spread, both[:controls, :controls], atol=1e-9)
    np.testing.assert_allclose(statistics.cross, both[:controls, controls:], atol=1e-9)
    np.testing.assert_array_equal(statistics.scale, np.maximum(truth.std(axis=0), TUNING.least_scale))
    np.testing.assert_array_equal(statistics.mean, truth.mean(axis=0))


def test_the_regression_minimises_the_damped_squared_error(truth: Array, statistics: Statistics) -> None:
    columns = np.array([0, 2])
    controls = (measure(truth) - statistics.rest)[:, columns]
    noise = TUNING.control_noise_mm * np.sqrt(len(truth)) * np.eye(len(columns))
    rows, weights = np.vstack([controls, noise]), np.vstack([truth - statistics.mean, np.zeros((2, len(SHAPES)))])
    plain = np.linalg.lstsq(rows, weights, rcond=None)[0]
    np.testing.assert_allclose(regression(columns, statistics), plain, atol=1e-9)


def test_poses_move_towards_targets_by_their_blend_and_only_where_there_is_a_target(
    truth: Array, statistics: Statistics
) -> None:
    targets = np.full((len(truth), len(CONTROL_INDEX)), np.nan)
    targets[SPAN, 0] = measure(truth)[SPAN, 0] + 4.0
    blend = np.zeros_like(truth)
    blend[100:] = 1.0
    moved = regress_controls(truth, blend, targets, statistics)
    np.testing.assert_array_equal(moved[:100], truth[:100])
    np.testing.assert_array_equal(moved[SPAN.stop :], truth[SPAN.stop :])
    opened = (measure(moved) - measure(truth))[100 : SPAN.stop, 0]
    assert 2.0 < np.median(opened) < 6.0 and moved.min() >= 0 and moved.max() <= 1
