from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from app.session.left_over import LeftOver, new_path, unsaved_folder, unsaved_work
from engine import project
from engine.errors import EngineError
from engine.formats import write_take
from engine.project import Contents, Edit
from engine.take import SHAPES, Take


def kept(folder: Path, take: Take, *, edits: int = 0) -> Path:
    rows = np.full((2, len(SHAPES)), 0.5), np.full((2, 16), np.nan)
    edit = Edit("paste", "paste", 3, *rows, {})
    path = new_path(folder)
    project.create(path, Contents(take, (edit,) * edits, edits)).close()
    return path


def test_names_of_unsaved_work_are_all_different_and_of_projects(tmp_path: Path) -> None:
    folder = tmp_path / "a" / "b"
    paths = [new_path(folder) for _ in range(20)]
    assert folder.is_dir() and len(set(paths)) == 20
    assert all(path.parent == folder and path.suffix == project.ENDING and not path.exists() for path in paths)


def test_a_folder_that_cannot_be_made_is_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(EngineError, match=r"Unsaved work cannot be kept in .*: not a directory\."):
        new_path(tmp_path / "file" / "folder")


def test_unsaved_work_is_listed_newest_first_with_its_length_and_edits(tmp_path: Path, random_take: Take) -> None:
    first = kept(tmp_path, random_take)
    second = kept(tmp_path, replace(random_take, name="other"), edits=2)
    found = unsaved_work(tmp_path)
    assert {each.path for each in found} == {first, second}
    assert [each.changed for each in found] == sorted((each.changed for each in found), reverse=True)
    told = {each.name: (each.edits, each.length) for each in found}
    assert told["other"][0] == 2 and told["random"][0] == 0
    assert told["other"][1] == "00:00:01:10"


def test_what_is_open_elsewhere_or_damaged_is_left_where_it_is(tmp_path: Path, random_take: Take) -> None:
    path = kept(tmp_path, random_take)
    damaged = tmp_path / "damaged.retake"
    damaged.write_bytes(b"nothing of the kind")
    opened = project.Project.open(path)
    try:
        assert unsaved_work(tmp_path) == [] and path.exists() and damaged.exists()
    finally:
        opened.close()
    assert [each.path for each in unsaved_work(tmp_path)] == [path] and damaged.exists()


def test_a_recording_that_was_cut_short_becomes_unsaved_work(tmp_path: Path, random_take: Take) -> None:
    partial = tmp_path / "take.partial-1.csv"
    write_take(random_take, tmp_path / "whole.csv")
    content = (tmp_path / "whole.csv").read_bytes()
    (tmp_path / "whole.csv").unlink()
    partial.write_bytes(content[:-40])  # half a row is missing
    (found,) = unsaved_work(tmp_path)
    assert not partial.exists() and found.path.suffix == project.ENDING
    opened = project.Project.open(found.path, read_only=True)
    opened.close()
    take = opened.contents.original
    assert len(take) == len(random_take) - 1
    np.testing.assert_allclose(take.weights, random_take.weights[:-1], atol=1e-6)


def test_a_line_of_the_list_tells_what_it_is() -> None:
    left = LeftOver(Path("a"), "walk", 1, datetime(2025, 1, 2, 3, 4, tzinfo=UTC), "00:01:00:00")
    local = left.changed.astimezone()
    assert left.sentence == f"walk (00:01:00:00), 1 edit, {local:%d %b %Y %H:%M}"
    assert "2 edits" in replace(left, edits=2).sentence


def test_unsaved_work_has_a_folder_of_its_own() -> None:
    assert unsaved_folder().name == "unsaved" and unsaved_folder().is_absolute()
