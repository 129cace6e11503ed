from __future__ import annotations

import numpy as np
import pytest

from engine.character import bundled
from engine.lab.evaluate.plausibility import STRETCH, recorded
from engine.lab.performer.corpus import synthetic_performances
from engine.take import SHAPE_INDEX, SHAPES

COLUMNS = np.arange(len(SHAPES))


def test_a_recorded_stretch_is_no_distance_from_the_recordings() -> None:
    take = synthetic_performances(0.2, seed=1)[0]
    assert recorded([take], COLUMNS).distance_mm(take[: 4 * STRETCH]).max() < 0.02


def test_distance_is_that_of_the_surface() -> None:
    """A stretch that differs by one constant pose is as far away as that pose moves the mesh."""
    deltas = bundled().deltas.astype(np.float64)
    moving = np.abs(deltas).max(axis=(0, 2)) > 0.1
    jaw = SHAPE_INDEX["jawOpen"]
    still, open_jaw = np.zeros((STRETCH, len(SHAPES))), np.zeros((STRETCH, len(SHAPES)))
    open_jaw[:, jaw] = 0.5
    expected = 0.5 * np.sqrt((deltas[jaw, moving] ** 2).sum(axis=1).mean())
    assert recorded([still], COLUMNS).distance_mm(open_jaw)[0] == pytest.approx(expected, rel=1e-3)
