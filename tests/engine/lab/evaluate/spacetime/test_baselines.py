from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from engine.lab.evaluate.spacetime.baselines import per_frame, per_frame_bounded, per_frame_prior
from engine.spacetime.retarget import Correspondence
from engine.take import Array


@pytest.fixture
def pair() -> Correspondence:
    rng = np.random.default_rng(0)
    basis, motion = rng.normal(size=(30, 8)), 4 * rng.normal(size=(25, 30))
    return Correspondence(basis, np.arange(8), motion, None, np.zeros((0, 8)), np.zeros((25, 0)), np.zeros((25, 0)))


def test_bounded_frames_equal_scipys(pair: Correspondence) -> None:
    found = per_frame_bounded(pair, -0.5, 1.0)
    expected = [lsq_linear(pair.basis, frame, (-0.5, 1.0), method="bvls", tol=1e-14).x for frame in pair.motion]
    np.testing.assert_allclose(found, expected, atol=1e-6)


def test_free_frames_are_the_best_fit(pair: Correspondence) -> None:
    expected = np.linalg.lstsq(pair.basis, pair.motion.T)[0].T
    np.testing.assert_allclose(per_frame(pair), expected, atol=1e-6)


def test_a_prior_shrinks_the_fit_towards_rest(pair: Correspondence) -> None:
    sizes: list[Array] = [np.abs(per_frame_prior(pair, alpha)) for alpha in (1e-9, 0.1, 10.0)]
    np.testing.assert_allclose(sizes[0], np.abs(per_frame(pair)), atol=1e-6)
    assert sizes[0].mean() > sizes[1].mean() > sizes[2].mean()


def test_a_trip_to_the_second_head_and_back(real_take_path: Path) -> None:
    from engine.formats import read_take
    from engine.lab.corpus import Piece
    from engine.lab.evaluate.spacetime import table as spacetime

    pieces = [Piece(np.clip(read_take(real_take_path).weights[1590:1650], 0, 1), True, "alex")]
    for condition in spacetime.CONDITIONS:
        ours = spacetime.measure(pieces, spacetime.METHODS["movement_matching"], condition)
        theirs = spacetime.measure(pieces, spacetime.METHODS["per_frame_prior"], condition)
        assert ours["velocity_error"] < theirs["velocity_error"]
        assert ours["weight_overshoot"] == 0
        assert ours["closure_missed"] <= theirs["closure_missed"]
