from __future__ import annotations

import numpy as np
import pytest

from engine.errors import EditError
from engine.spacetime.prior import from_poses, from_shapes

RNG = np.random.default_rng(0)
BASIS = RNG.normal(size=(60, 12)) * RNG.gamma(1.0, 2.0, size=12)


def test_the_cost_is_the_papers() -> None:
    """``v' Lambda^-1 v`` with ``v = E' (B w + n - mean)``, E and Lambda by PCA of the shapes' markers."""
    mean = BASIS.mean(axis=1)
    values, vectors = np.linalg.eigh((BASIS - mean[:, None]) @ (BASIS - mean[:, None]).T / 12)
    kept = values > 1e-9 * values[-1]
    weights = RNG.random((5, 12))
    coordinates = (weights @ BASIS.T - mean) @ vectors[:, kept]
    expected = (coordinates**2 / np.maximum(values[kept], 1e-4 * values[-1])).sum(axis=1)
    found = from_shapes(BASIS, about_rest=False)
    beyond = ((weights @ BASIS.T - mean) ** 2).sum(axis=1) - (coordinates**2).sum(axis=1)  # where no example differs
    np.testing.assert_allclose(found.cost(weights), expected + beyond / (1e-4 * values[-1]), rtol=1e-6)


def test_a_face_at_rest_costs_nothing_and_shapes_cost_alike() -> None:
    prior = from_shapes(RNG.normal(size=(60, 12)))
    assert prior.cost(np.zeros((1, 12)))[0] == 0
    np.testing.assert_allclose(prior.cost(np.eye(12)), 12)


def test_size_and_number_of_markers_do_not_change_what_alpha_means() -> None:
    weights = RNG.random((4, 12))

    def relative(basis: np.ndarray) -> np.ndarray:
        prior = from_shapes(basis)
        return prior.scale(basis) * prior.cost(weights) / (basis**2).sum()

    np.testing.assert_allclose(relative(BASIS), relative(7 * BASIS))
    np.testing.assert_allclose(relative(BASIS), relative(np.vstack([BASIS, BASIS])))


def test_poses_that_takes_show_cost_less_than_others() -> None:
    poses = RNG.random((500, 12)) * np.array([1.0] * 6 + [0.01] * 6)
    costs = from_poses(BASIS, poses).cost(np.eye(12))
    assert costs[:6].max() < costs[6:].min()


def test_shapes_that_cancel_are_kept_small() -> None:
    basis = np.hstack([BASIS, -BASIS[:, :1]])
    both = np.zeros((1, 13))
    both[0, [0, 12]] = 1.0
    assert from_shapes(basis).cost(both)[0] > 1


def test_examples_that_move_nothing_are_refused() -> None:
    with pytest.raises(EditError, match="move no marker"):
        from_poses(BASIS, np.zeros((3, 12)))
