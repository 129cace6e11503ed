from __future__ import annotations

import numpy as np

from engine.lab.speed import spacetime


def test_the_sparse_solve_is_of_the_same_problem() -> None:
    basis, source, held = spacetime._problem(40)
    plain, ours = spacetime._sparse(basis, source, held), spacetime._solve(basis, source, held)
    np.testing.assert_allclose(ours, plain, atol=1e-9)
