from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from engine.spacetime import bounded
from engine.spacetime.matching import Bounds
from engine.spacetime.prior import from_shapes
from engine.spacetime.solve import MovementMatcher
from engine.spacetime.system import System
from tests.engine.spacetime import plain
from tests.engine.spacetime.systems import basis_of, held_at, source_of


@pytest.mark.parametrize("rounds", [80, 1], ids=["exchange", "newton"])
@pytest.mark.parametrize("pinned", [[], [0], [4, 5]])
def test_bounds_equal_bounded_least_squares(pinned: list[int], rounds: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bounded, "TUNING", bounded.Tuning(rounds=rounds))
    frames, basis = 9, basis_of(6, markers=5)
    system = System(basis, frames, from_shapes(basis), 0.05)
    held, values = held_at(frames, 6, pinned)
    held[7, 2] = True
    source = 4 * source_of(frames, 5)
    found = MovementMatcher(system, held, bounds=Bounds(-0.5, 1.5)).solve(source, values=values)
    matrix, side = plain.stacked(system, source, None)
    free = ~held.ravel()
    side = side - matrix @ np.where(held, values, 0).ravel()
    best = lsq_linear(matrix.toarray()[:, free], side, (-0.5, 1.5), method="bvls", tol=1e-14).x
    np.testing.assert_allclose(found[~held], best, atol=1e-6)
    assert (found[~held] == -0.5).any() and (found[~held] == 1.5).any()
    np.testing.assert_array_equal(found[held], values[held])


def test_what_lies_within_its_bounds_is_left_as_it_is_and_rounds_are_told() -> None:
    basis = basis_of(6, markers=5)
    system = System(basis, 9, from_shapes(basis), 0.05)
    held, values = held_at(9, 6, [0])
    free = MovementMatcher(system, held).solve(source_of(9, 5), values=values)
    wide = MovementMatcher(system, held, bounds=Bounds(free.min() - 1, free.max() + 1)).solve(
        source_of(9, 5), values=values
    )
    np.testing.assert_array_equal(wide, free)
    shares: list[float] = []
    matcher = MovementMatcher(system, held, bounds=Bounds(-0.2, 0.3), progress=shares.append)
    found = matcher.solve(4 * source_of(9, 5), values=values)
    assert shares == sorted(shares) and all(0 <= share <= 1 for share in shares) and len(shares) >= 1
    assert found[1:].min() == -0.2 and found[1:].max() == 0.3
