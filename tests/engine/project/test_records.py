"""What a file says of how its take is read is believed only where it can be."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from engine import project
from engine.errors import FormatError
from engine.formats.base.reading import ReadAs, Reading
from engine.project import Contents, Project, replay
from engine.project.records import reading_edit
from engine.take import Take
from tests.engine.project.projects import reopened, same, sql

READ = ReadAs(Reading(30.0, "named"), 30.0, swapped=False)


@pytest.fixture
def path(random_take: Take, tmp_path: Path) -> Path:
    step = reading_edit("rate 30 fps", ReadAs(Reading(), random_take.fps, swapped=True), READ)
    contents = Contents(random_take, (step,), 1)
    project.create(tmp_path / "a.retake", contents).close()
    assert same(reopened(tmp_path / "a.retake"), contents)
    return tmp_path / "a.retake"


def test_a_reading_comes_back_as_it_was(path: Path) -> None:
    assert replay(reopened(path)).reading == READ


@pytest.mark.parametrize(
    "stored",
    [
        {},
        [],
        None,
        {"chosen": {}, "fps": 30.0},
        {"chosen": {}, "fps": 0.0, "swapped": True},
        {"chosen": {}, "fps": -1.0, "swapped": True},
        {"chosen": {}, "fps": 1e300, "swapped": True},
        {"chosen": {}, "fps": float("nan"), "swapped": True},
        {"chosen": {}, "fps": "30", "swapped": True},
        {"chosen": {}, "fps": 30.0, "swapped": 1},
        {"chosen": {"fps": 1e9}, "fps": 30.0, "swapped": True},
        {"chosen": {"fps": "x"}, "fps": 30.0, "swapped": True},
        {"chosen": {"fps": 10**400}, "fps": 30.0, "swapped": True},
        {"chosen": {"sides": ["recorded"]}, "fps": 30.0, "swapped": True},
        {"chosen": {"sides": "up"}, "fps": 30.0, "swapped": True},
        {"chosen": {"other": 1}, "fps": 30.0, "swapped": True},
        {"chosen": 5, "fps": 30.0, "swapped": True},
    ],
    ids=str,
)
def test_a_reading_that_cannot_be_is_a_sentence(path: Path, stored: Any) -> None:
    right = {"chosen": {}, "fps": 30.0, "swapped": True}
    sql(path, "UPDATE edits SET inputs = ?", values=(json.dumps({"before": right, "after": stored}),))
    with pytest.raises(FormatError, match="does not say how the take is read"):
        Project.open(path)
