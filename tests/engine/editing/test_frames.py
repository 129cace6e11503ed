from __future__ import annotations

import numpy as np
import pytest

from engine.editing.frames import parse_frames
from engine.errors import EditError
from engine.take import SHAPES, Take

TAKE = Take(np.zeros((60, len(SHAPES))), 30.0)


@pytest.mark.parametrize("text", ["0:60", "59:60", "0:1", " 40 : 50 "])
def test_a_range_within_the_take_is_read(text: str) -> None:
    assert parse_frames(text, TAKE) == tuple(int(part) for part in text.split(":"))


@pytest.mark.parametrize("text", ["-1:5", "0:61", "5:5", "6:5", "60:61"])
def test_a_range_beyond_the_take_is_told_with_its_length(text: str) -> None:
    with pytest.raises(EditError, match=f"Frames {text} are not within the take, which has 60 frames"):
        parse_frames(text, TAKE)


@pytest.mark.parametrize("text", ["", "5", "5-6", "a:b", "1:2:3", "1.5:3"])
def test_what_is_no_range_is_told_how_to_write(text: str) -> None:
    with pytest.raises(EditError) as told:
        parse_frames(text, TAKE)
    assert told.value.sentence == f"{text!r} is not a range of frames." and "40:60" in told.value.advice
