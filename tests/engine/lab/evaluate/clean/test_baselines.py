from __future__ import annotations

import numpy as np
import pytest

from engine.lab.evaluate.clean.baselines import Filter, Kalman, OneEuro, exponential, gaussian, raw, savgol
from engine.lab.evaluate.clean.table import events
from engine.lab.performer.degrade import Tracked
from engine.lab.train.clean.rivals import FullyConnected, Rival, Trees, derivatives, features, targets
from engine.lab.train.clean.tuning import _boost
from engine.take import SHAPES

RNG = np.random.default_rng(0)
TIMES = np.cumsum(RNG.uniform(1 / 120, 1 / 24, 200))
CURVES = RNG.random((200, len(SHAPES)))
TRACKED = Tracked(CURVES, np.zeros(200, bool))
CAUSAL = [raw, exponential(0.5), OneEuro(2.0, 1.0), Kalman(10.0)]
ALL = [*CAUSAL, gaussian(1), savgol(7, 2)]


@pytest.mark.parametrize("method", ALL)
def test_a_constant_stays(method: Filter) -> None:
    still = Tracked(np.full((60, len(SHAPES)), 0.4), np.zeros(60, bool))
    np.testing.assert_allclose(method(still, TIMES[:60]), still.weights, atol=1e-9)


@pytest.mark.parametrize("method", CAUSAL)
def test_what_does_not_look_ahead_does_not_know_the_future(method: Filter) -> None:
    cut = Tracked(CURVES[:100], TRACKED.lost[:100])
    np.testing.assert_allclose(method(cut, TIMES[:100]), method(TRACKED, TIMES)[:100])


@pytest.mark.parametrize("method", ALL[1:])
def test_every_filter_calms_noise(method: Filter) -> None:
    assert np.diff(method(TRACKED, TIMES), axis=0).std() < 0.8 * np.diff(CURVES, axis=0).std()


def test_one_euro_lets_speed_through() -> None:
    step = Tracked(np.repeat([0.0, 1.0], 50)[:, None] * np.ones(len(SHAPES)), np.zeros(100, bool))
    times = np.arange(100) / 60
    assert OneEuro(1.0, 16.0)(step, times)[55, 0] > OneEuro(1.0, 0.0)(step, times)[55, 0] + 0.2


def test_kalman_equals_a_plain_one_for_a_single_shape() -> None:
    made = Kalman(10.0, noise=1e-3)(TRACKED, TIMES)[:, 3]
    x, p = np.array([CURVES[0, 3], 0.0]), np.diag([1e-3, 1.0])
    for index, step in enumerate(np.diff(TIMES), start=1):
        f = np.array([[1, step], [0, 1]])
        q = 10.0 * np.array([[step**3 / 3, step**2 / 2], [step**2 / 2, step]])
        x, p = f @ x, f @ p @ f.T + q
        h = np.array([[1.0, 0.0]])
        gain = p @ h.T / (h @ p @ h.T + 1e-3)
        x = x + (gain * (CURVES[index, 3] - x[0]))[:, 0]
        p = (np.eye(2) - gain @ h) @ p
        x[0] = np.clip(x[0], 0, 1)
        assert made[index] == pytest.approx(x[0], abs=1e-9)


def test_kalman_predicts_what_is_lost() -> None:
    times = np.arange(60) / 60
    rising = np.tile((times * 0.5)[:, None], (1, len(SHAPES)))
    lost = np.arange(60) >= 50
    held = Tracked(np.where(lost[:, None], rising[49], rising), lost)
    np.testing.assert_allclose(Kalman(10.0)(held, times)[50:], rising[50:], atol=0.02)


@pytest.mark.parametrize("orders", [1, 2])
def test_rivals_given_the_truth_return_it(orders: int) -> None:
    smooth = 0.5 + 0.3 * np.sin(TIMES[:, None] * np.linspace(1, 4, len(SHAPES)))
    flat = targets(smooth, TIMES, orders)
    made = Rival(lambda seen: flat, orders, leak=1.0).summed(flat, smooth, TIMES)
    np.testing.assert_allclose(made, smooth, atol=1e-9)
    assert features(smooth, TIMES, orders).shape == (200, (2 * orders + 1) * len(SHAPES))
    np.testing.assert_allclose(derivatives(smooth, TIMES, 1)[0][1:], np.diff(smooth, axis=0) / np.diff(TIMES)[:, None])


def test_a_rival_without_a_leak_is_the_input() -> None:
    made = Rival(FullyConnected(1).estimate, 1, leak=0.0)(TRACKED, TIMES)
    np.testing.assert_allclose(made, CURVES)


def test_stored_trees_equal_the_library_that_grew_them() -> None:
    sklearn = pytest.importorskip("sklearn.ensemble")
    seen = RNG.random((400, 5)).astype(np.float32).astype(np.float64)
    wanted = np.stack([seen[:, 2] * seen[:, 3], np.sin(5 * seen[:, 0]) + seen[:, 1]], axis=1)
    trees = _boost(seen, wanted, trees=3, leaves=6)
    model = sklearn.HistGradientBoostingRegressor(
        max_iter=3, max_leaf_nodes=6, learning_rate=0.15, early_stopping=False, random_state=0
    ).fit(seen, wanted[:, 1])
    assert isinstance(trees, Trees)
    np.testing.assert_allclose(trees.estimate(seen)[:, 1], model.predict(seen), atol=1e-5)


def test_a_closure_is_found_when_half_of_it_is_closed() -> None:
    def closed(weights: np.ndarray, times_s: np.ndarray) -> np.ndarray:
        return weights[:, 0] > 0.5

    truth, made = np.zeros((40, 1)), np.zeros((40, 1))
    truth[5:9], truth[15:19], truth[25:29] = 1, 1, 1
    made[7:11], made[18:19], made[33:35] = 1, 1, 1
    assert events(truth, made, np.arange(40.0), closed) == (3, 1, 1)
