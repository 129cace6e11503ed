from __future__ import annotations

import numpy as np
import pytest

from engine.spacetime.blocks import Tuning
from engine.spacetime.prior import from_shapes
from engine.spacetime.solve import MovementMatcher
from engine.spacetime.system import System
from tests.engine.spacetime import plain
from tests.engine.spacetime.systems import PINS, basis_of, held_at, positions_of, source_of


@pytest.mark.parametrize("pinned", PINS.values(), ids=PINS.keys())
@pytest.mark.parametrize("shapes", [18, 33, 50, 52])
def test_block_path_equals_the_assembled_system(shapes: int, pinned: list[int]) -> None:
    frames, basis = 20, basis_of(shapes)
    position, places = positions_of(frames, shapes, by_frame=True)
    confidence = (np.random.default_rng(5).random((frames - 1, 20)) > 0.1).astype(float).repeat(3, axis=1)
    system = System(basis, frames, from_shapes(basis), 0.01, position, confidence)
    held, values = held_at(frames, shapes, pinned)
    held[12, ::3] = held[4, 1] = True  # single weights
    matcher = MovementMatcher(system, held)
    assert not matcher.separable
    found = matcher.solve(source_of(frames), places=places, values=values)
    np.testing.assert_allclose(found, plain.solve(system, source_of(frames), held, values, places), atol=1e-6)
    np.testing.assert_array_equal(found[held], values[held])


@pytest.mark.parametrize("frames", [2, 3, 255, 256, 257, 1500])
def test_block_path_at_any_length(frames: int, monkeypatch: pytest.MonkeyPatch) -> None:
    basis = basis_of(18)
    position, places = positions_of(frames, 18, by_frame=True)
    system = System(basis, frames, from_shapes(basis), 0.2, position)
    held, values = held_at(frames, 18, [])
    held[-1, 3] = True
    found = MovementMatcher(system, held).solve(source_of(frames), places=places, values=values)
    np.testing.assert_allclose(found, plain.solve(system, source_of(frames), held, values, places), atol=1e-6)
    monkeypatch.setattr("engine.spacetime.blocks.TUNING", Tuning(kept_frames=1))  # a take too long to keep the factor
    again = MovementMatcher(system, held).solve(source_of(frames), places=places, values=values)
    np.testing.assert_array_equal(again, found)
