from __future__ import annotations

from dataclasses import replace

import pytest

from engine.character import bundled
from engine.formats import read_take
from engine.jaw import drawable
from engine.lab.performer import demo
from engine.spacetime.source import Source, from_take
from engine.take import Take


@pytest.fixture(scope="module")
def take() -> Take:
    whole = read_take(demo.BUNDLED)
    return replace(whole, weights=drawable(whole.weights[:150]), lost=whole.lost[:150], rotations=whole.rotations[:150])


@pytest.fixture(scope="module")
def played(take: Take) -> Source:
    return from_take(take, bundled())
