from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from app import cli
from engine.character import BUNDLED, bundled, load
from engine.formats import read_take
from engine.formats.characters.animation import write
from engine.formats.characters.moving import MovingMesh
from engine.performance import demo
from engine.spacetime.layout import standard


@pytest.fixture
def foreign(tmp_path: Path) -> Path:
    """A folder of OBJ files in centimetres, made of the bundled head."""
    head, folder = bundled(), tmp_path / "anna"
    folder.mkdir()
    faces = "".join(f"f {a} {b} {c}\n" for a, b, c in head.triangles + 1)
    for name, shape in (("neutral", None), ("JawOpen", 17), ("Mouth_Smile_L", 23)):
        vertices = (head.neutral + (0 if shape is None else head.deltas[shape])) / 10
        (folder / f"{name}.obj").write_text("".join(f"v {x:.5f} {y:.5f} {z:.5f}\n" for x, y, z in vertices) + faces)
    return folder


def test_import_shows_its_guesses_and_writes_a_character(
    foreign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "anna.npz"
    arguments = ["character", "import", str(foreign), "-o", str(out), "--landmark", "chin=5", "--json"]
    assert cli.run(arguments) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["unit"] == "cm" and said["up"] == "y" and said["landmarks"]["chin"] == 5
    assert {row["source"]: row["shape"] for row in said["shapes"]} == {
        "JawOpen": "jawOpen",
        "Mouth_Smile_L": "mouthSmileLeft",
    }
    np.testing.assert_allclose(load(out).neutral, bundled().neutral, atol=1e-2)


def test_a_match_can_be_corrected(foreign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "anna.npz"
    arguments = ["character", "import", str(foreign), "-o", str(out), "--name", "Mouth_Smile_L=", "--json"]
    assert cli.run(arguments) == 0
    shapes = {row["source"]: row["shape"] for row in json.loads(capsys.readouterr().out)["shapes"]}
    assert shapes["Mouth_Smile_L"] == ""


def test_a_take_drives_a_mesh_without_shapes(foreign: Path, tmp_path: Path) -> None:
    out = tmp_path / "driven.npz"
    arguments = ["drive", str(demo.BUNDLED), "--mesh", str(foreign / "neutral.obj"), "-o", str(out)]
    assert cli.run(arguments) == 0
    take = read_take(demo.BUNDLED)
    with np.load(out, allow_pickle=False) as made:
        assert made["vertices"].shape == (len(take), len(bundled().neutral), 3)
        true = np.stack([bundled().vertices(weights) for weights in take.weights[::20]])
        points = bundled().neutral[standard(bundled()).vertices]
        face = cKDTree(points).query(bundled().neutral)[0] < 15  # beyond the points nothing tells what the skin does
        away = np.linalg.norm(made["vertices"][::20] - true, axis=2)[:, face].mean()
        still = np.linalg.norm(bundled().neutral - true, axis=2)[:, face].mean()
    assert away < 0.7 * still


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["character", "import", "{missing}", "-o", "{out}"], "is not there"),
        (["character", "import", "{folder}", "-o", "{out}", "--unit", "ell"], "no unit called 'ell'"),
        (["character", "import", "{folder}", "-o", "{out}", "--landmark", "chin"], "not a name and a value"),
        (["character", "import", "{folder}", "-o", "{out}", "--landmark", "chin=x"], "needs the number"),
        (["character", "import", "{folder}", "-o", "{out}", "--name", "grin=jawOpen"], "no shape called 'grin'"),
        (["character", "landmarks", "{folder}", "-o", "{out}", "--landmark", "ear=3"], "no landmark called 'ear'"),
        (["drive", "{missing}", "--mesh", "{folder}", "-o", "{out}"], "could not be read"),
    ],
)
def test_mistakes_get_one_sentence(
    arguments: list[str], says: str, foreign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    places = {"missing": tmp_path / "none.csv", "folder": foreign, "out": tmp_path / "out.npz"}
    assert cli.run([part.format(**places) for part in arguments]) == 2
    assert says in capsys.readouterr().err
    assert not (tmp_path / "out.npz").exists()


def test_a_mesh_of_few_vertices_is_driven_by_few_points_and_told_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mesh, points, out = tmp_path / "few.obj", tmp_path / "points.csv", tmp_path / "out.npz"
    mesh.write_text("v 0 0 0\nv 90 0 0\nv 0 90 0\nv 0 0 90\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n")
    drive = ["drive", str(demo.BUNDLED), "--mesh", str(mesh), "-o", str(out)]
    assert cli.run(drive) == 2
    told = capsys.readouterr().err
    assert "is a feature point twice." in told and "fewer points in a marker,vertex file" in told
    points.write_text("marker,vertex\nforehead,2\nnose_tip,3\nchin,0\ncheek_left,1\n")
    assert cli.run([*drive, "--points", str(points)]) == 0 and np.load(out)["vertices"].shape == (322, 4, 3)


def test_a_moving_mesh_of_another_program_is_a_character_too(tmp_path: Path) -> None:
    head = bundled()
    frames = np.stack([head.neutral, head.vertices(np.full(52, 0.5))])
    write(MovingMesh(head.neutral.astype(float), head.triangles, frames, 30.0), tmp_path / "m.glb")
    assert cli.run(["character", "import", str(tmp_path / "m.glb"), "-o", str(tmp_path / "m.npz")]) == 0


def test_landmarks_are_found_anew_around_those_placed_by_hand(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    head, out = bundled(), tmp_path / "head.npz"
    chin = head.landmarks["chin"] + 1
    arguments = ["character", "landmarks", str(BUNDLED), "-o", str(out), "--landmark", f"chin={chin}", "--json"]
    assert cli.run(arguments) == 0
    rows = {row["landmark"]: row for row in json.loads(capsys.readouterr().out)["rows"]}
    assert rows["chin"] == {"landmark": "chin", "vertex": chin, "away_mm": 0.0, "by_hand": True}
    found = load(out).landmarks
    assert found["chin"] == chin and set(found) == set(head.landmarks)
    for name in set(found) - {"chin"}:
        assert np.linalg.norm(head.neutral[found[name]] - head.neutral[head.landmarks[name]]) < 3, name
