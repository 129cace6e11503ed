from __future__ import annotations

import numpy as np
import pytest

from engine.formats import livelink
from engine.lab.performer import demo
from engine.project import Contents
from engine.take import SHAPES, Take
from tests.engine.project.projects import sample, stored


@pytest.fixture
def contents(random_take: Take) -> Contents:
    return sample(random_take)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A sound project file of 40 frames, four edits and every kind of mark."""
    rng = np.random.default_rng(3)
    take = Take(weights=rng.random((40, len(SHAPES))), fps=30.0, name="random")
    return stored(sample(take), tmp_path_factory.mktemp("whole"))


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A sound project file of a take that came from a recording."""
    return stored(Contents(livelink.read(demo.BUNDLED)), tmp_path_factory.mktemp("recorded"))
