from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from engine.controls import ALL_INDEX
from engine.extended import bundled_face
from engine.regress.prior import bundled_prior
from engine.regress.projection import project
from engine.regress.solve import FREE
from engine.take import SHAPES, Array

FACE = bundled_face()
METRIC = bundled_prior().metric(100.0)
LOWER = np.where(FREE["lower"][:, None] & FREE["lower"], METRIC, 0.0)
LIPS, WIDE = ALL_INDEX["lips_vertical"], ALL_INDEX["lips_horizontal"]


def faces(count: int = 6) -> Array:
    weights = np.random.default_rng(0).uniform(0.05, 0.5, (count, len(SHAPES)))
    weights[:, SHAPES.index("mouthClose")] = 0.0
    return weights


def reached(weights: Array, asked: Array, columns: list[int], hold: Array | None = None) -> Array:
    held = np.ones(asked.shape, bool) if hold is None else hold
    return project(weights, asked, np.array(columns), hold=held, covariance=LOWER, measurer=FACE)


def test_asked_distances_are_reached_by_free_shapes_alone_within_their_limits() -> None:
    weights = faces()
    asked = FACE.measure(weights)[:, [LIPS, WIDE]] + [4.0, -2.0]
    found = reached(weights, asked, [LIPS, WIDE])
    np.testing.assert_allclose(FACE.measure(found)[:, [LIPS, WIDE]], asked, atol=1e-3)
    np.testing.assert_array_equal(found[:, ~FREE["lower"]], weights[:, ~FREE["lower"]])
    assert found.min() >= 0 and found.max() <= 1


def test_what_is_not_held_or_there_already_moves_nothing() -> None:
    weights = faces()
    own = FACE.measure(weights)[:, [LIPS]]
    np.testing.assert_array_equal(reached(weights, own, [LIPS]), weights)
    hold = np.array([[True], [False]] * 3)
    found = reached(weights, own + 3.0, [LIPS], hold)
    np.testing.assert_array_equal(found[1::2], weights[1::2])
    np.testing.assert_allclose(FACE.measure(found)[::2, LIPS], own[::2, 0] + 3.0, atol=1e-3)


def test_the_change_is_the_smallest_in_the_metric_of_recorded_faces() -> None:
    weights = faces(1)
    asked = FACE.measure(weights)[:, [LIPS]] + 2.0
    found = reached(weights, asked, [LIPS])
    free = np.flatnonzero(FREE["lower"])
    precision = np.linalg.pinv(LOWER[np.ix_(free, free)])

    def whole(part: Array) -> Array:
        face = weights.copy()
        face[0, free] = part
        return face

    def cost(part: Array) -> float:
        away = part - weights[0, free]
        return float(away @ precision @ away)

    best = minimize(
        cost,
        found[0, free],
        method="SLSQP",
        bounds=[(0, 1)] * len(free),
        constraints={"type": "eq", "fun": lambda part: FACE.measure(whole(part))[0, LIPS] - asked[0, 0]},
        options={"maxiter": 60},
    )
    assert cost(found[0, free]) <= 1.05 * best.fun + 1e-9


@pytest.mark.parametrize("asked_mm", [0.0, 0.5, 1.4])
def test_lips_meet_point_on_point_where_little_is_asked(asked_mm: float) -> None:
    weights = faces()
    found = reached(weights, np.full((6, 1), asked_mm), [LIPS])
    np.testing.assert_allclose(FACE.measure(found)[:, LIPS], asked_mm, atol=0.05)


def test_weights_outside_the_range_may_stay_where_they_were_and_go_no_further() -> None:
    weights = faces()
    jaw = SHAPES.index("jawOpen")
    weights[:, jaw] = 1.2
    found = reached(weights, FACE.measure(weights)[:, [LIPS]] + 5.0, [LIPS])
    assert found[:, jaw].max() <= 1.2 and found.min() >= 0
