from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from engine.errors import FormatError
from engine.lab.corpus import Piece
from engine.lab.evaluate.inpaint.blind import _fresh, exhibits, key_of, score
from engine.lab.evaluate.inpaint.table import Hole, holes
from engine.lab.performer import demo
from engine.lab.performer.performer import perform


def test_a_sheet_is_half_filled_and_filled_stretches_differ_only_inside() -> None:
    piece = Piece(np.asarray(perform(demo.SCRIPT).weights), True, "demo")
    sheet = exhibits([piece], count=8, seed=3)
    assert [one.answer for one in sheet].count("filled") == 4
    key = json.loads(key_of(sheet))
    assert list(key) == [one.name for one in sheet]
    for one in sheet:
        starts = np.flatnonzero((piece.weights == one.take.weights[0]).all(axis=1))
        truth = piece.weights[starts[0] : starts[0] + len(one.take)]
        changed = np.flatnonzero((truth != one.take.weights).any(axis=1))
        assert bool(len(changed)) == (one.answer == "filled")


def test_no_moment_is_shown_twice_while_there_are_others() -> None:
    piece = Piece(np.asarray(perform(demo.SCRIPT).weights), True, "demo")
    rng = np.random.default_rng(0)
    found, seen = holes([piece], 30, 200), list[Hole]()
    for _ in range(3):
        seen.append(_fresh(found, seen, rng))
    starts = sorted(hole.start for hole in seen)
    assert all(later - earlier >= 30 for earlier, later in pairwise(starts))


def written(folder: Path, answers: dict[str, str]) -> tuple[Path, Path]:
    key, table = folder / "key.json", folder / "answers.csv"
    key.write_text(json.dumps({"01": {"answer": "recorded"}, "02": {"answer": "filled"}, "03": {"answer": "filled"}}))
    table.write_text("\n".join(["movie,answer", *(f"{name},{said}" for name, said in answers.items())]))
    return table, key


def test_answers_are_scored(tmp_path: Path) -> None:
    figures = score(*written(tmp_path, {"01": "recorded", "02": "Recorded", "03": "filled"}))
    assert figures["recorded_taken_for_recorded"] == 1.0
    assert figures["filled_taken_for_recorded"] == 0.5
    assert figures["right"] == pytest.approx(2 / 3)


@pytest.mark.parametrize("answers", [{}, {"01": "maybe"}, {"99": "filled"}])
def test_answers_that_do_not_count_are_named(tmp_path: Path, answers: dict[str, str]) -> None:
    with pytest.raises(FormatError, match=r"answers\.csv"):
        score(*written(tmp_path, answers))
