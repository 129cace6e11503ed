from __future__ import annotations

import numpy as np
import pytest

from engine.errors import EditError
from engine.spacetime.prior import from_shapes
from engine.spacetime.system import TUNING, Position, System
from tests.engine.spacetime import plain
from tests.engine.spacetime.systems import basis_of, positions_of, source_of

FRAMES, SHAPES = 7, 5


def systems() -> dict[str, System]:
    basis = basis_of(SHAPES, markers=4)
    by_frame, alike = positions_of(FRAMES, SHAPES, by_frame=True)[0], positions_of(FRAMES, SHAPES, by_frame=False)[0]
    confidence = np.random.default_rng(5).choice([0.0, 0.25, 1.0], (FRAMES - 1, 12))
    prior = from_shapes(basis, about_rest=False)
    return {
        "plain": System(basis, FRAMES),
        "prior": System(basis, FRAMES, prior, 0.3),
        "places": System(basis, FRAMES, None, 0.0, alike),
        "places by frame": System(basis, FRAMES, prior, 0.3, by_frame),
        "doubted": System(basis, FRAMES, prior, 0.3, by_frame, confidence),
        "stiff": System(basis, FRAMES, prior, 0.3, alike, confidence, stiffness=0.7),
    }


@pytest.mark.parametrize("name", systems())
def test_applying_equals_the_normal_equations_of_the_stacked_rows(name: str) -> None:
    system = systems()[name]
    rng = np.random.default_rng(0)
    source, places = source_of(FRAMES, 4), rng.normal(size=(FRAMES, 9))
    matrix, side = plain.stacked(system, source, places)
    weights = rng.normal(size=(FRAMES, SHAPES))
    np.testing.assert_allclose(system.apply(weights).ravel(), matrix.T @ (matrix @ weights.ravel()), atol=1e-7)
    np.testing.assert_allclose(system.right_side(source, places).ravel(), matrix.T @ side, atol=1e-7)


@pytest.mark.parametrize("name", systems())
@pytest.mark.parametrize(("start", "stop"), [(0, FRAMES), (0, 1), (2, 5), (5, FRAMES), (FRAMES - 1, FRAMES)])
def test_blocks_are_those_of_the_assembled_matrix(name: str, start: int, stop: int) -> None:
    system = systems()[name]
    matrix, _ = plain.stacked(system, source_of(FRAMES, 4), None)
    whole = (matrix.T @ matrix).toarray().reshape(FRAMES, SHAPES, FRAMES, SHAPES)
    diagonal, coupling = system.blocks(start, stop)
    assert diagonal.shape == coupling.shape == (stop - start, SHAPES, SHAPES)
    for at in range(start, stop):
        np.testing.assert_allclose(diagonal[at - start], whole[at, :, at], atol=1e-7)
        expected = whole[at + 1, :, at] if at + 1 < FRAMES else np.zeros((SHAPES, SHAPES))
        np.testing.assert_allclose(coupling[at - start], expected, atol=1e-7)


def test_frames_are_alike_unless_places_or_doubts_differ() -> None:
    alike = {name: system.uniform for name, system in systems().items()}
    assert alike == {
        "plain": True,
        "prior": True,
        "places": True,
        "places by frame": False,
        "doubted": False,
        "stiff": False,
    }
    assert TUNING.stiffness < 1e-6 and systems()["plain"].count == SHAPES


def test_shapes_that_move_a_marker_without_end_are_refused() -> None:
    basis = basis_of(SHAPES)
    basis[3, 2] = np.inf
    with pytest.raises(EditError, match="not a finite number"):
        System(basis, 4)


def test_a_basis_of_nothing_still_costs_its_own_steps() -> None:
    system = System(np.zeros((6, 3)), 4, position=Position(np.eye(3), np.ones(3)))
    assert (np.diag(system.velocity_gram()) > 0).all()
    np.testing.assert_array_equal(system.constant_gram(), np.eye(3))
