"""Every step on the visemes comes back from the file, and can be taken back."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from engine import project
from engine.errors import FormatError
from engine.project import Contents, Edit, Project
from engine.speech.lane import VisemeLane, attached, renamed, restored, shifted, with_boundary
from engine.speech.visemes import Cue
from engine.take import Take
from tests.engine.project.projects import reopened


def said(seed: int) -> list[tuple[Edit, VisemeLane | None, VisemeLane | None]]:
    """A random walk of steps on the visemes: attached, moved, named, shifted, restored, removed."""
    rng = np.random.default_rng(seed)
    lane, edits = None, []
    for step in range(20):
        turn = int(rng.integers(0, 8)) if lane is not None else 0
        if turn == 0:
            at = np.sort(rng.random(int(rng.integers(2, 9)))) * 5
            after = attached([Cue(a, b, "M") for a, b in pairwise(at)], f"{step}.TextGrid")
        elif turn == 1:
            after = None
        elif turn == 2:
            after = shifted(lane, float(rng.normal()))
        elif turn == 3:
            after = restored(lane)
        elif turn == 4:
            after = renamed(lane, int(rng.integers(0, len(lane.cues))), "AA1")
        else:
            after = with_boundary(lane, *lane.end_of(int(rng.integers(0, len(lane.cues)))), float(rng.random() * 5))
        edits.append((project.viseme_edit(f"step {step}", project.change_between(lane, after)), lane, after))
        lane = after
    return edits


def told(lane: VisemeLane | None) -> object:
    return None if lane is None else (lane.cues, lane.originals, lane.source, lane.offset_s)


@pytest.mark.parametrize("seed", range(6))
def test_every_step_on_the_visemes_comes_back_and_can_be_taken_back(
    seed: int, random_take: Take, tmp_path: Path
) -> None:
    steps = said(seed)
    edits = tuple(edit for edit, _, _ in steps)
    for position in (0, 7, len(edits)):
        path = tmp_path / f"{position}.retake"
        project.create(path, Contents(random_take, edits, position)).close()
        state = project.replay(reopened(path))
        assert told(state.visemes) == (told(steps[position - 1][2]) if position else None)
        for change, (_, before, after) in zip(state.changes, steps, strict=True):
            assert told(change.applied(before)) == told(after)
            assert told(change.inverse.applied(after)) == told(before)


def test_a_step_on_a_long_lane_is_small(random_take: Take) -> None:
    lane = attached([Cue(at / 10, at / 10 + 0.1, "M") for at in range(1000)], "long.TextGrid")
    for after in (renamed(lane, 500, "AA1"), with_boundary(lane, 500, 501, 50.12), shifted(lane, 1.0)):
        edit = project.viseme_edit("step", project.change_between(lane, after))
        assert len(json.dumps(dict(edit.inputs))) < 300


@pytest.mark.parametrize(
    "wrong",
    [
        {"at": 5},
        {"at": -1},
        {"at": "0"},
        {"removed": 2},
        {"added": [[0.0, 1.0]]},
        {"added": [[0.0, 1.0, "quux"]]},
        {"added": [[1.0, 0.0, "M"]]},
        {"added": [[0.0, 1e300, "M"]]},
        {"added": [[0.0, 2.0, "M"], [1.0, 3.0, "M"]]},
        {"added": 3},
        {"lane": {"source": 1, "offset_s": 0.0, "attached": True}},
        {"lane": {"source": "", "offset_s": "x", "attached": True}},
        {"lane": {"source": "", "offset_s": 0.0, "attached": False}},
        {"lane": 4},
        {"lane": {}},
    ],
)
def test_a_step_on_the_visemes_that_cannot_be_is_refused(
    wrong: dict[str, object], random_take: Take, tmp_path: Path
) -> None:
    (edit, *_), *_ = said(0)
    broken = replace(edit, inputs={**edit.inputs, **wrong})
    project.create(tmp_path / "a.retake", Contents(random_take, (broken,), 1)).close()
    with pytest.raises(FormatError, match="visemes"):
        Project.open(tmp_path / "a.retake")
