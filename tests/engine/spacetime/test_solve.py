from __future__ import annotations

import numpy as np
import pytest

from engine.errors import EditError
from engine.spacetime.solve import MovementMatcher
from engine.spacetime.system import System
from engine.take import Array
from tests.engine.spacetime.systems import basis_of


def test_a_motion_of_the_shapes_comes_back() -> None:
    rng = np.random.default_rng(6)
    weights, basis = rng.random((50, 33)), rng.normal(size=(60, 33))
    held = np.zeros_like(weights, bool)
    held[0] = True
    found = MovementMatcher(System(basis, 50), held).solve(weights @ basis.T, values=weights)
    np.testing.assert_allclose(found, weights, atol=1e-5)


@pytest.mark.parametrize("confidence", [None, np.ones((9, 60))], ids=["modes", "blocks"])
def test_a_motion_that_starts_nowhere_is_refused(confidence: Array | None) -> None:
    with pytest.raises(EditError, match="starts"):
        MovementMatcher(System(basis_of(18), 10, confidence=confidence))
