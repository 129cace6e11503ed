from __future__ import annotations

import numpy as np
import pytest

from engine.formats.characters.animation import targets
from engine.formats.characters.moving import MovingMesh


@pytest.mark.parametrize("modes", [0, 1, 3])
def test_as_many_independent_motions_as_a_mesh_has_are_its_targets(modes: int) -> None:
    rng = np.random.default_rng(modes)
    rest, shapes = rng.normal(0, 50, (30, 3)), rng.normal(0, 5, (modes, 30, 3))
    weights = rng.random((20, modes))
    frames = (rest + np.tensordot(weights, shapes, 1)).astype(np.float32)
    found, played = targets(MovingMesh(rest, np.array([[0, 1, 2]], np.int32), frames, 30.0))
    assert len(found) == modes and played.shape == (20, modes)
    np.testing.assert_allclose(rest + np.tensordot(played, found, 1), frames, atol=0.02)
