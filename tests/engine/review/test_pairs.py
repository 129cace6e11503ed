from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from engine.errors import EngineError
from engine.formats import read_take, write_take
from engine.lab.performer import demo
from engine.review.pairs import flags, pairs, review
from engine.take import SHAPE_INDEX


@pytest.fixture
def edited(tmp_path: Path) -> tuple[Path, Path]:
    before, after = tmp_path / "shot.csv", tmp_path / "shot_edited.csv"
    shutil.copy(demo.BUNDLED, before)
    take = read_take(before)
    weights = take.weights.copy()
    weights[60:80, SHAPE_INDEX["jawOpen"]] += 0.3
    write_take(take.with_weights(weights), after)
    return before, after


def test_two_files_are_reviewed(edited: tuple[Path, Path]) -> None:
    found = review(*edited)
    assert [(change.start, change.stop) for change in found.comparison.changes] == [(60, 80)]
    assert flags(edited[1]) == found.flags_after


def test_a_take_alone_has_no_original(edited: tuple[Path, Path]) -> None:
    with pytest.raises(EngineError, match="does not hold what it was made from"):
        review(None, edited[1])


def test_pairs_are_found_side_by_side_and_in_two_folders(edited: tuple[Path, Path], tmp_path: Path) -> None:
    assert pairs(tmp_path) == [edited]
    for name, path in zip(("before", "after"), edited, strict=True):
        (tmp_path / name).mkdir()
        shutil.copy(path, tmp_path / name / "shot.csv")
    assert pairs(tmp_path) == [(tmp_path / "before" / "shot.csv", tmp_path / "after" / "shot.csv")]


def test_a_folder_without_pairs_is_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(EngineError, match="no pairs"):
        pairs(tmp_path)
