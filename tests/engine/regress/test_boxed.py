"""The nearest values within a box, held against a solver that is known."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from engine.regress.boxed import Boxes, nearest
from engine.take import Array

SOFT = 1e-4


def problem(seed: int, values: int = 12, goals: int = 3, count: int = 6) -> tuple[Boxes, Array, Array, Array]:
    """Return boxes, many of which start at a bound, slopes, goals that not all can be reached, and a covariance."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(values, values)) / values
    start = np.where(rng.random((count, values)) < 0.5, 0.0, rng.random((count, values)))
    boxes = Boxes(start, np.zeros_like(start), np.ones_like(start))
    slopes, goals_at = rng.normal(0, 5, (count, goals, values)), rng.normal(0, 4, (count, goals))
    return boxes, slopes, goals_at, root @ root.T + 0.01 * np.eye(values)


def found(boxes: Boxes, slopes: Array, goals: Array, covariance: Array) -> Array:
    sides = np.zeros_like(boxes.start)
    return nearest(boxes, slopes, goals, covariance=covariance, softness=SOFT, sides=sides)


@settings(deadline=None, max_examples=40, derandomize=True)
@given(seed=st.integers(0, 10_000))
def test_it_is_the_least_that_a_known_solver_finds(seed: int) -> None:
    boxes, slopes, goals, covariance = problem(seed)
    root = np.linalg.cholesky(np.linalg.inv(covariance)).T
    for row, values in enumerate(found(boxes, slopes, goals, covariance)):
        system = np.concatenate([root, slopes[row] / np.sqrt(SOFT)])
        wanted = np.concatenate([root @ boxes.start[row], goals[row] / np.sqrt(SOFT)])
        best = lsq_linear(system, wanted, (0.0, 1.0), method="bvls", tol=1e-14).x
        cost, least = (((system @ x - wanted) ** 2).sum() for x in (values, best))
        assert cost <= least * (1 + 1e-6) + 1e-9


@settings(deadline=None, max_examples=40, derandomize=True)
@given(seed=st.integers(0, 10_000))
def test_a_little_elsewhere_comes_out_a_little_elsewhere(seed: int) -> None:
    boxes, slopes, goals, covariance = problem(seed)
    moved = found(boxes, slopes, goals + 1e-6, covariance) - found(boxes, slopes, goals, covariance)
    assert np.abs(moved).max() < 1e-3


@settings(deadline=None, max_examples=40, derandomize=True)
@given(seed=st.integers(0, 10_000), more=st.floats(0.1, 20.0))
def test_a_goal_further_away_is_never_met_less(seed: int, more: float) -> None:
    boxes, slopes, goals, covariance = problem(seed, goals=1)
    less, further = (
        (slopes @ found(boxes, slopes, goal, covariance)[..., None])[..., 0] for goal in (goals, goals + more)
    )
    assert (further - less).min() >= -1e-6
