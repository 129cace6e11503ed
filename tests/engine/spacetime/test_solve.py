from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from engine.errors import EditError
from engine.spacetime.matching import Bounds
from engine.spacetime.prior import from_shapes
from engine.spacetime.solve import MovementMatcher
from engine.spacetime.system import Position, System
from engine.take import Array, Mask

sys.path.insert(0, str(Path(__file__).parent))
import plain


def _basis(shapes: int, *, rank: int | None = None, markers: int = 20, seed: int = 0) -> Array:
    rng = np.random.default_rng(seed)
    basis = rng.normal(size=(3 * markers, shapes)) * rng.gamma(1.0, 2.0, size=shapes)
    if rank is not None:
        basis[:, rank:] = basis[:, :rank] @ rng.normal(size=(rank, shapes - rank))
    return basis


def _source(frames: int, markers: int = 20, seed: int = 1) -> Array:
    return np.cumsum(np.random.default_rng(seed).normal(size=(frames, 3 * markers)), axis=0)


def _held(frames: int, shapes: int, pinned: list[int]) -> tuple[Mask, Array]:
    held = np.zeros((frames, shapes), bool)
    held[pinned] = True
    return held, np.random.default_rng(2).random((frames, shapes))


PINS = {
    "first": [0],
    "last": [-1],
    "both ends": [0, -1],
    "middle": [5],
    "adjacent": [0, 5, 6, 7, -1],
    "none": [],
}


@pytest.mark.parametrize("pinned", PINS.values(), ids=PINS.keys())
@pytest.mark.parametrize("shapes", [18, 33, 50, 52])
def test_fast_path_equals_the_assembled_system(shapes: int, pinned: list[int]) -> None:
    frames, basis = 20, _basis(shapes)
    system = System(basis, frames, from_shapes(basis, about_rest=False), alpha=0.01)
    held, values = _held(frames, shapes, pinned)
    matcher = MovementMatcher(system, held)
    assert matcher.separable
    found = matcher.solve(_source(frames), values=values)
    np.testing.assert_allclose(found, plain.solve(system, _source(frames), held, values), atol=1e-6)


@pytest.mark.parametrize("frames", [2, 3, 12, 300, 1500])
def test_fast_path_at_any_length(frames: int) -> None:
    basis = _basis(18)
    system = System(basis, frames, from_shapes(basis), alpha=0.5)
    held, values = _held(frames, 18, [0])
    found = MovementMatcher(system, held).solve(_source(frames), values=values)
    np.testing.assert_allclose(found, plain.solve(system, _source(frames), held, values), atol=1e-6)


@pytest.mark.parametrize("pinned", [[0], [0, -1], [3, 9, 10]])
def test_a_singular_basis_without_a_prior(pinned: list[int]) -> None:
    basis = _basis(33, rank=20)
    basis[:, 7] = 0.0
    system = System(basis, 30)
    held, values = _held(30, 33, pinned)
    found = MovementMatcher(system, held).solve(_source(30), values=values)
    np.testing.assert_allclose(found, plain.solve(system, _source(30), held, values), atol=1e-6)


def _positions(frames: int, shapes: int, *, by_frame: bool) -> tuple[Position, Array]:
    rng = np.random.default_rng(4)
    weights = rng.random((frames, 9)) * (rng.random((frames, 9)) < 0.3) if by_frame else rng.random(9)
    return Position(rng.normal(size=(9, shapes)), 5 * weights), rng.normal(size=(frames, 9))


def test_fast_path_with_held_places() -> None:
    position, places = _positions(40, 33, by_frame=False)
    system = System(_basis(33), 40, from_shapes(_basis(33)), 0.1, position)
    held, values = _held(40, 33, [0, 20])
    matcher = MovementMatcher(system, held)
    assert matcher.separable
    found = matcher.solve(_source(40), places=places, values=values)
    np.testing.assert_allclose(found, plain.solve(system, _source(40), held, values, places), atol=1e-6)


@pytest.mark.parametrize("pinned", PINS.values(), ids=PINS.keys())
@pytest.mark.parametrize("shapes", [18, 33, 50, 52])
def test_block_path_equals_the_assembled_system(shapes: int, pinned: list[int]) -> None:
    frames, basis = 20, _basis(shapes)
    position, places = _positions(frames, shapes, by_frame=True)
    believed = (np.random.default_rng(5).random((frames - 1, 20)) > 0.1).astype(float).repeat(3, axis=1)
    system = System(basis, frames, from_shapes(basis), 0.01, position, believed)
    held, values = _held(frames, shapes, pinned)
    held[12, ::3] = held[4, 1] = True  # single weights
    matcher = MovementMatcher(system, held)
    assert not matcher.separable
    found = matcher.solve(_source(frames), places=places, values=values)
    np.testing.assert_allclose(found, plain.solve(system, _source(frames), held, values, places), atol=1e-6)
    np.testing.assert_array_equal(found[held], values[held])


@pytest.mark.parametrize("frames", [2, 3, 255, 256, 257, 1500])
def test_block_path_at_any_length(frames: int, monkeypatch: pytest.MonkeyPatch) -> None:
    basis = _basis(18)
    position, places = _positions(frames, 18, by_frame=True)
    system = System(basis, frames, from_shapes(basis), 0.2, position)
    held, values = _held(frames, 18, [])
    held[-1, 3] = True
    found = MovementMatcher(system, held).solve(_source(frames), places=places, values=values)
    np.testing.assert_allclose(found, plain.solve(system, _source(frames), held, values, places), atol=1e-6)
    monkeypatch.setattr("engine.spacetime.blocks.KEPT", 1)  # a take too long to keep the factor
    again = MovementMatcher(system, held).solve(_source(frames), places=places, values=values)
    np.testing.assert_array_equal(again, found)


@pytest.mark.parametrize("rounds", [80, 1], ids=["exchange", "newton"])
@pytest.mark.parametrize("pinned", [[], [0], [4, 5]])
def test_bounds_equal_bounded_least_squares(pinned: list[int], rounds: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("engine.spacetime.bounded.ROUNDS", rounds)
    frames, basis = 9, _basis(6, markers=5)
    system = System(basis, frames, from_shapes(basis), 0.05)
    held, values = _held(frames, 6, pinned)
    held[7, 2] = True
    source = 4 * _source(frames, 5)
    found = MovementMatcher(system, held, bounds=Bounds(-0.5, 1.5)).solve(source, values=values)
    matrix, side = plain.stacked(system, source, None)
    free = ~held.ravel()
    side = side - matrix @ np.where(held, values, 0).ravel()
    best = lsq_linear(matrix.toarray()[:, free], side, (-0.5, 1.5), method="bvls", tol=1e-14).x
    np.testing.assert_allclose(found[~held], best, atol=1e-6)
    assert (found[~held] == -0.5).any() and (found[~held] == 1.5).any()
    np.testing.assert_array_equal(found[held], values[held])


def test_a_motion_of_the_shapes_comes_back() -> None:
    rng = np.random.default_rng(6)
    weights, basis = rng.random((50, 33)), rng.normal(size=(60, 33))
    held = np.zeros_like(weights, bool)
    held[0] = True
    found = MovementMatcher(System(basis, 50), held).solve(weights @ basis.T, values=weights)
    np.testing.assert_allclose(found, weights, atol=1e-5)


@pytest.mark.parametrize("believed", [None, np.ones((9, 60))], ids=["modes", "blocks"])
def test_a_motion_that_starts_nowhere_is_refused(believed: Array | None) -> None:
    with pytest.raises(EditError, match="starts"):
        MovementMatcher(System(_basis(18), 10, believed=believed))
