from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from engine.errors import FormatError
from engine.formats import livelink
from engine.formats.livelink.packing import pack, unpack
from engine.take import Take
from tests.engine.formats.livelink.files import Writer, content_of


@pytest.fixture
def take(tmp_path: Path) -> Take:
    path = tmp_path / "a.csv"
    lost = np.isin(np.arange(12), (4, 5))
    path.write_bytes(content_of(Writer(), lost, np.zeros(12, bool), 0))
    return livelink.read(path)


def test_what_is_packed_unpacks_to_the_same_file(take: Take) -> None:
    packed = pack(take)
    assert packed is not None
    again, origin = unpack(packed, take), take.origin
    assert isinstance(origin, livelink.Origin)
    assert (again.content, again.swapped, again.timecodes) == (origin.content, origin.swapped, origin.timecodes)
    for name in ("starts", "rows", "lost", "weights", "rotations"):
        np.testing.assert_array_equal(getattr(again, name), getattr(origin, name))


def test_a_take_that_is_no_longer_as_it_was_read_has_nothing_to_pack(take: Take) -> None:
    weights = take.weights.copy()
    weights[3, 3] += 0.1
    assert pack(replace(take, weights=weights)) is None
    assert pack(replace(take, origin=None)) is None


@pytest.mark.parametrize(
    "damage",
    [
        {"rows": np.arange(12)[::-1]},
        {"rows": np.arange(1, 13)},
        {"rows": np.arange(11), "lost": np.zeros(11, bool)},
        {"lost": np.ones(12, bool)},
        {"content": b"one line\n"},
        {"content": b"x" * 70_000 + b"\n" + b"a\n" * 12},
    ],
)
def test_parts_that_cannot_be_of_the_take_are_refused(take: Take, damage: dict[str, object]) -> None:
    packed = pack(take)
    assert packed is not None
    with pytest.raises(ValueError):
        unpack(replace(packed, **damage), take)


def test_a_text_that_is_no_such_file_is_a_sentence(take: Take) -> None:
    packed = pack(take)
    assert packed is not None
    with pytest.raises(FormatError):
        unpack(replace(packed, content=b"x\n" + b"a\n" * 12), take)
