from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.controls import CONTROL_INDEX
from engine.editing import ask, drag_exact, parse_frames
from engine.errors import EditError
from engine.formats import read_take
from engine.performance import demo

LIPS = CONTROL_INDEX["lips_vertical"]


def test_closing_the_lips_exactly_keeps_all_other_frames() -> None:
    take = read_take(demo.BUNDLED)
    edit = drag_exact(take, ask(take, "lips_vertical", (40, 60), "set", 0.0))
    start, stop = edit.touched
    assert edit.reached[40:60, LIPS].max() < 0.5
    assert 30 <= start <= 40 and 60 <= stop <= 70
    outside = np.r_[0:start, stop : len(take)]
    np.testing.assert_array_equal(edit.take.weights[outside], take.weights[outside])


def test_closing_the_lips_of_a_real_take(real_take_path: Path) -> None:
    take = read_take(real_take_path)
    edit = drag_exact(take, ask(take, "lips_vertical", (1600, 1620), "set", 0.0))
    assert edit.reached[1600:1620, LIPS].max() <= 2.0


@pytest.mark.parametrize("text", ["", "5", "60:40", "-1:5", "0:100000", "a:b"])
def test_a_range_outside_the_take_is_refused(text: str) -> None:
    with pytest.raises(EditError):
        parse_frames(text, read_take(demo.BUNDLED))
