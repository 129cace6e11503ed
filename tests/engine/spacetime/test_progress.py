"""A solve tells how far it is, and can be stopped."""

from __future__ import annotations

import numpy as np
import pytest

from engine.character import bundled
from engine.formats import read_take
from engine.lab.performer import demo
from engine.spacetime.retarget import retarget
from engine.spacetime.source import Source, from_take
from engine.spacetime.system import System
from engine.take import Take


class Enough(Exception):
    pass


@pytest.fixture(scope="module")
def source() -> Source:
    return from_take(read_take(demo.BUNDLED), bundled()).part(60, 90)


def test_the_share_rises_to_one_and_the_result_is_the_same(source: Source) -> None:
    shares: list[float] = []
    told = retarget(source, bundled(), progress=shares.append)
    assert shares == sorted(shares) and 0.5 < shares[-1] <= 1 and len(shares) > 2
    np.testing.assert_array_equal(told.weights, retarget(source, bundled()).weights)


def test_it_stops_at_the_next_word(source: Source, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []
    blocks = System.blocks
    monkeypatch.setattr(System, "blocks", lambda self, *frames: asked.append(1) or blocks(self, *frames))

    def tell(_: float) -> None:
        raise Enough

    with pytest.raises(Enough):
        retarget(source, bundled(), progress=tell)
    assert len(asked) <= 1


def test_a_short_range_looks_as_it_will_in_the_whole_take() -> None:
    """What the window shows live, some frames around the playhead, is what solving the whole take brings."""
    take: Take = read_take(demo.BUNDLED)
    whole = from_take(take, bundled()).part(0, 150)
    expected = retarget(whole, bundled()).weights[63:88]
    live = retarget(whole.part(63, 88), bundled()).weights
    assert np.abs(live - expected)[6:-6].max() < 0.01
