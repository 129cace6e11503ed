from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.errors import FormatError
from engine.formats.characters.raw import RawCharacter, check

POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1e9, 0.0]])
RAW = RawCharacter("a", POINTS, np.array([[0, 1, 2]], np.int32), {"jaw": np.full((3, 3), -1e9, np.float32)})


def test_a_sound_mesh_comes_back_as_it_is() -> None:
    assert check(RAW) is RAW


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"vertices": POINTS[:0]}, "a holds no mesh"),
        ({"triangles": RAW.triangles[:0]}, "a holds no mesh"),
        ({"vertices": np.where(POINTS == 1, np.nan, POINTS)}, "not at a finite place: number 1"),
        ({"vertices": np.where(POINTS == 1, np.inf, POINTS)}, "number 1"),
        ({"triangles": np.array([[0, 1, 3]], np.int32)}, "names vertex 3; it has 3 vertices"),
        ({"triangles": np.array([[0, 1, -1]], np.int32)}, "has a face that names vertex"),
        ({"vertices": POINTS * 1.001}, "further away than a head can be"),
        ({"vertices": -POINTS * 1.001}, "further away than a head can be"),
        ({"vertices": POINTS * 0 + 5}, "all its vertices at one place"),
        ({"shapes": {"jaw": np.zeros((2, 3), np.float32)}}, "has 2 vertices in its shape 'jaw', 3 in its neutral"),
        ({"shapes": {"jaw": np.full((3, 3), np.nan, np.float32)}}, "not a finite number in its shape 'jaw'"),
        ({"shapes": {"jaw": np.full((3, 3), -1.1e9, np.float32)}}, "not a finite number in its shape 'jaw'"),
    ],
)
def test_the_first_thing_that_cannot_be_used_is_named(change: dict, says: str) -> None:
    with pytest.raises(FormatError, match=says):
        check(replace(RAW, **change))
