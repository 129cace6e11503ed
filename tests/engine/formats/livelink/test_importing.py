from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from engine.formats import read_take, write_take
from engine.formats.base.reading import Reading
from engine.formats.livelink.importing import imported
from engine.take import SHAPES, Take


@pytest.fixture
def path(tmp_path: Path) -> Path:
    write_take(Take(np.full((30, len(SHAPES)), 0.2), 30.0), tmp_path / "take_cal.csv")
    (tmp_path / "take.json").write_text(json.dumps({"videoTargetFrameRate": 50}))
    return tmp_path / "take_cal.csv"


def test_a_rate_is_from_the_timecodes_unless_it_was_asked_for(path: Path) -> None:
    said = imported(read_take(path))
    assert said is not None
    assert said.rate_reason(30.0) == "from timecodes that count sixtieths of a second"
    assert said.rate_reason(25.0, Reading(25.0)) == "as asked; the timecodes say 30"


def test_a_rate_may_be_from_the_card_of_the_take(path: Path) -> None:
    header, *rows = path.read_text().splitlines()
    path.write_text("\n".join([header, *(f"now{row[row.index(',') :]}" for row in rows)]))
    take = read_take(path)
    said = imported(take)
    assert said is not None and take.fps == 50.0
    assert said.rate_reason(take.fps) == "from take.json; the timecodes say no rate that can be believed"


def test_sides_that_were_asked_for_are_said_beside_what_the_motion_tells(path: Path) -> None:
    said = imported(read_take(path))
    assert said is not None and said.sides_reason(swapped=True) == "no sideways motion to tell by"


def test_a_take_of_no_file_says_nothing() -> None:
    assert imported(Take(np.zeros((4, len(SHAPES))), 30.0)) is None
