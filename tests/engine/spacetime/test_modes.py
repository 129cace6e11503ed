from __future__ import annotations

import numpy as np
import pytest

from engine.spacetime.prior import from_shapes
from engine.spacetime.solve import MovementMatcher
from engine.spacetime.system import System
from tests.engine.spacetime import plain
from tests.engine.spacetime.systems import PINS, basis_of, held_at, positions_of, source_of


@pytest.mark.parametrize("pinned", PINS.values(), ids=PINS.keys())
@pytest.mark.parametrize("shapes", [18, 33, 50, 52])
def test_fast_path_equals_the_assembled_system(shapes: int, pinned: list[int]) -> None:
    frames, basis = 20, basis_of(shapes)
    system = System(basis, frames, from_shapes(basis, about_rest=False), alpha=0.01)
    held, values = held_at(frames, shapes, pinned)
    matcher = MovementMatcher(system, held)
    assert matcher.separable
    found = matcher.solve(source_of(frames), values=values)
    np.testing.assert_allclose(found, plain.solve(system, source_of(frames), held, values), atol=1e-6)


@pytest.mark.parametrize("frames", [2, 3, 12, 300, 1500])
def test_fast_path_at_any_length(frames: int) -> None:
    basis = basis_of(18)
    system = System(basis, frames, from_shapes(basis), alpha=0.5)
    held, values = held_at(frames, 18, [0])
    found = MovementMatcher(system, held).solve(source_of(frames), values=values)
    np.testing.assert_allclose(found, plain.solve(system, source_of(frames), held, values), atol=1e-6)


@pytest.mark.parametrize("pinned", [[0], [0, -1], [3, 9, 10]])
def test_a_singular_basis_without_a_prior(pinned: list[int]) -> None:
    basis = basis_of(33, rank=20)
    basis[:, 7] = 0.0
    system = System(basis, 30)
    held, values = held_at(30, 33, pinned)
    found = MovementMatcher(system, held).solve(source_of(30), values=values)
    np.testing.assert_allclose(found, plain.solve(system, source_of(30), held, values), atol=1e-6)


def test_fast_path_with_held_places() -> None:
    position, places = positions_of(40, 33, by_frame=False)
    system = System(basis_of(33), 40, from_shapes(basis_of(33)), 0.1, position)
    held, values = held_at(40, 33, [0, 20])
    matcher = MovementMatcher(system, held)
    assert matcher.separable
    found = matcher.solve(source_of(40), places=places, values=values)
    np.testing.assert_allclose(found, plain.solve(system, source_of(40), held, values, places), atol=1e-6)
