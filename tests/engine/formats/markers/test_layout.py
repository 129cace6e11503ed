from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from engine.character import Character, bundled
from engine.errors import FormatError
from engine.formats.markers.layout import read, write

COUNT = len(bundled().neutral)
PLACES = {"nose_tip": 4, "brow, left": 0, "chin": COUNT - 1}


def split(character: Character) -> Character:
    """The head as read from a file that has each of its vertices twice, in turn."""
    return replace(character, split=np.arange(COUNT, dtype=np.int32).repeat(2))


def test_what_is_written_reads_back(tmp_path: Path) -> None:
    for head in (bundled(), split(bundled())):
        write(PLACES, tmp_path / "a.csv", head=head)
        assert read(tmp_path / "a.csv", head=head) == PLACES
    assert (tmp_path / "a.csv").read_text().splitlines()[:2] == ["marker,vertex", "nose_tip,8"]


def test_numbers_are_those_of_the_file_that_the_head_came_from(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(f"Marker , VERTEX\n\nx,9\ny, {2 * COUNT - 1}\n")
    assert read(tmp_path / "a.csv", head=split(bundled())) == {"x": 4, "y": COUNT - 1}


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("name,vertex\na,1\n", "does not begin with the row marker,vertex"),
        ("marker,vertex\n", "names no marker"),
        ("marker,vertex\na,1\nb,x\n", "has 'x' for a vertex in row 3"),
        ("marker,vertex\na,-1\n", "has '-1' for a vertex in row 2"),
        ("marker,vertex\na,1.5\n", "'1.5'"),
        ("marker,vertex\na,²\n", "'²'"),
        (f"marker,vertex\na,{COUNT}\n", f"'{COUNT}'.*There are {COUNT}"),
        ("marker,vertex\na," + "1" * 30 + "\n", "1{20}' for a vertex"),
        ("marker,vertex\na,1\na,2\n", "'a' twice or not at all in row 3"),
        ("marker,vertex\n,2\n", "'' twice or not at all in row 2"),
    ],
)
def test_what_is_wrong_is_named_with_its_row(tmp_path: Path, text: str, says: str) -> None:
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(FormatError, match=says):
        read(tmp_path / "a.csv", head=bundled())
