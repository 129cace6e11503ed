from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.errors import FormatError
from engine.formats.characters import read

QUAD = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nf 1/1 2/2 3/3 4/4\nf -4 -3 -2\n"


def folder(tmp_path: Path, **files: str) -> Path:
    for name, text in files.items():
        (tmp_path / f"{name}.obj").write_text(text)
    return tmp_path


def test_each_file_is_a_shape_of_the_neutral_one(tmp_path: Path) -> None:
    opened = QUAD.replace("v 0 1 0.5", "v 0 0.25 0.5")
    raw = read(folder(tmp_path, generic_neutral_mesh=QUAD, jawOpen=opened))
    np.testing.assert_array_equal(raw.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]])
    assert list(raw.shapes) == ["jawOpen"]
    np.testing.assert_array_equal(raw.shapes["jawOpen"], [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, -0.75, 0]])


def test_the_one_file_that_is_no_shape_is_the_neutral_one(tmp_path: Path) -> None:
    assert list(read(folder(tmp_path, anna=QUAD, mouthPucker=QUAD)).shapes) == ["mouthPucker"]


def test_the_one_folder_within_that_holds_the_files_is_found(tmp_path: Path) -> None:
    (tmp_path / "pictures").mkdir()
    (tmp_path / "LICENSE").write_text("")
    (tmp_path / "FaceXModel").mkdir()
    folder(tmp_path / "FaceXModel", neutral=QUAD, mouthPucker=QUAD)
    assert list(read(tmp_path).shapes) == ["mouthPucker"]
    folder(tmp_path / "pictures", neutral=QUAD)
    with pytest.raises(FormatError, match="holds no OBJ file, but 2 folders in it do"):
        read(tmp_path)


@pytest.mark.parametrize(
    ("files", "says"),
    [
        ({"neutral": QUAD, "jawOpen": QUAD + "v 2 2 2\n"}, "jawOpen.obj has 5 vertices, neutral.obj has 4"),
        ({"jawOpen": QUAD}, "neutral face .* is missing"),
        ({"anna": QUAD, "berta": QUAD}, "could be any of anna.obj, berta.obj"),
        ({"neutral": QUAD.replace("0.5", "nan")}, "not a finite number in line 4"),
        ({"neutral": QUAD.replace("v 1 1 0", "v 1 one 0")}, "without three numbers in line 3"),
        ({"neutral": QUAD.replace("3/3", "9/9")}, "line 5"),
        ({"neutral": QUAD.replace("-4", "-9")}, "line 6"),
        ({"neutral": "no mesh"}, "no vertices"),
        ({"neutral": "v 0 0 0\nv 1 0 0\n"}, "no mesh"),
        ({}, "no OBJ file"),
    ],
)
def test_what_is_wrong_is_named(files: dict[str, str], says: str, tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=says):
        read(folder(tmp_path, **files))


def test_shapes_and_lines_are_counted_before_they_are_held(tmp_path: Path) -> None:
    triangle = "".join(f"v {n} {n % 7} {n % 3}\n" for n in range(200_000)) + "f 1 2 3\n"
    for number in range(170):
        path = tmp_path / ("neutral.obj" if number == 0 else f"shape{number}.obj")
        path.write_text(triangle) if number == 0 else path.write_text("v 0 0 0\n")
    with pytest.raises(FormatError, match="asks for 102,000,000 numbers"):
        read(tmp_path)
    (tmp_path / "long.obj").write_text("\n" * 11_000_000)
    with pytest.raises(FormatError, match="parts"):
        read(tmp_path / "long.obj")
