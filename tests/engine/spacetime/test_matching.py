from __future__ import annotations

import numpy as np
import pytest

from engine.character import bundled
from engine.formats import read_take
from engine.lab.performer import demo
from engine.spacetime.matching import Bounds, Matching
from engine.spacetime.retarget import retarget
from engine.spacetime.source import from_take


@pytest.mark.parametrize("bounds", [Bounds(), Bounds(0.1, 0.6)])
def test_weights_stay_within_the_bounds_that_are_asked_for(bounds: Bounds) -> None:
    source = from_take(read_take(demo.BUNDLED), bundled()).part(60, 75)
    markers = np.flatnonzero(np.abs(source.displacements).max(axis=(0, 2)) > 0)
    assert len(markers)
    found = retarget(source, bundled(), matching=Matching(bounds=bounds)).weights
    moved = found[:, np.ptp(found, axis=0) > 1e-6]
    assert moved.min() >= bounds.low - 1e-9 and moved.max() <= bounds.high + 1e-9
    assert (Matching().bounds, Bounds()) == (Bounds(0.0, 1.0), Bounds(0.0, 1.0))


def test_a_strong_prior_draws_the_face_to_rest_and_held_places_keep_it() -> None:
    source = from_take(read_take(demo.BUNDLED), bundled()).part(60, 75)
    plain, drawn, placed = (
        float(np.abs(retarget(source, bundled(), matching=asked).weights).sum())
        for asked in (Matching(), Matching(alpha=5.0), Matching(alpha=5.0, beta=50.0))
    )
    assert drawn < 0.9 * plain and drawn < placed
