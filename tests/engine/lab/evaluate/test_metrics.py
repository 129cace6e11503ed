from __future__ import annotations

import numpy as np
import pytest

from engine.lab.evaluate.metrics import closures, mse, tracking_error, velocity_error


def test_the_truth_keeps_every_closure_and_invents_none() -> None:
    distance = np.array([0.5, 3.0, 0.2, 8.0, 1.9])
    kept = closures(distance, distance, (1.0, 2.0))
    np.testing.assert_array_equal(kept.tpr, [1.0, 1.0])
    np.testing.assert_array_equal(kept.fpr, [0.0, 0.0])


def test_closures_are_counted_per_true_closure() -> None:
    truth = np.array([0.0, 0.0, 5.0, 5.0])
    made = np.array([0.0, 5.0, 0.0, 0.0])
    counted = closures(made, truth, (1.0,))
    assert counted.tpr[0] == 0.5
    assert counted.fpr[0] == 1.0  # two false ones for two true ones


def test_rates_are_unknown_where_the_truth_never_closes() -> None:
    counted = closures(np.zeros(3), np.full(3, 9.0), (1.0,))
    assert np.isnan(counted.tpr[0]) and np.isnan(counted.fpr[0])


def test_errors_of_a_known_offset() -> None:
    truth = np.random.default_rng(0).random((30, 2))
    assert mse(truth + 0.5, truth) == pytest.approx(0.25)
    np.testing.assert_allclose(tracking_error(truth, truth + np.array([1.0, -2.0])), [1.0, 2.0])
    assert velocity_error(truth + 1.0, truth, 30.0) == pytest.approx(0.0, abs=1e-12)
