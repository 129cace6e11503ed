from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from app import cli
from engine.character import BUNDLED, bundled, load, save
from engine.formats import read_take
from engine.formats.characters.animation import write
from engine.formats.characters.moving import MovingMesh
from engine.formats.markers import write as save_markers
from engine.lab.performer import demo
from engine.spacetime.layout import standard
from engine.take import SHAPE_INDEX, SHAPES
from tests.heads import capture, write_glb


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


def test_a_mesh_of_few_vertices_is_driven_by_few_points_with_a_notice(
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


def test_a_vrm_with_the_usual_traps_is_imported_and_its_table_printed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    names = {
        "mouthOpen": "mouthClose",
        "jawOpen": "jawOpen",
        "eyeBlinkLeft": "eyeBlinkLeft",
        "eyeBlinkRight": "eyeBlinkRight",
    }
    path = write_glb(tmp_path / "head.glb", names).rename(tmp_path / "head.vrm")
    assert cli.run(["character", "import", str(path), "-o", str(tmp_path / "a.npz")]) == 0
    told = capsys.readouterr().out
    assert "Read in m, y up, facing z." in told and "Left out: mouthOpen (jawOpen is there)." in told
    made = load(tmp_path / "a.npz")
    np.testing.assert_allclose(made.deltas[SHAPE_INDEX["jawOpen"]], bundled().deltas[SHAPE_INDEX["jawOpen"]], atol=0.05)


@pytest.mark.parametrize(
    ("more", "says"),
    [
        (["--landmark", "ear=3"], "no landmark called 'ear'"),
        (["--unit", "m"], "would hardly be seen"),
        (["--unit", "yard"], "no unit called 'yard'"),
        (["--up", "w"], "no upward axis called 'w'"),
        (["--facing", "1e9"], "turned by -360 to 360"),
    ],
)
def test_what_cannot_be_is_refused_and_nothing_written(
    more: list[str], says: str, foreign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "anna.npz"
    assert cli.run(["character", "import", str(foreign), "-o", str(out), *more]) == 2
    assert says in capsys.readouterr().err and not out.exists()


def test_facing_is_corrected_by_hand(foreign: Path, tmp_path: Path) -> None:
    out = tmp_path / "anna.npz"
    assert cli.run(["character", "import", str(foreign), "-o", str(out), "--facing", "90", "--up", "y"]) == 0
    turned = load(out).neutral
    np.testing.assert_allclose(turned[:, 0], -bundled().neutral[:, 2], atol=0.01)


@pytest.mark.parametrize("still", [False, True])
def test_a_driven_head_goes_and_turns_as_the_markers_do(still: bool, tmp_path: Path) -> None:
    weights = np.zeros((12, len(SHAPES)))
    angles = np.linspace([0, 0, 0], [25, 10, -8], 12)
    turns = Rotation.from_euler("yxz", angles, degrees=True).as_matrix()
    lab = np.array([[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]])
    save_markers(capture(weights, turn=lab, heads=turns), tmp_path / "m.trc")
    save(bundled(), tmp_path / "head.npz")
    arguments = [
        "drive",
        str(tmp_path / "m.trc"),
        "--mesh",
        str(tmp_path / "head.npz"),
        "-o",
        str(tmp_path / "out.npz"),
    ]
    assert cli.run(arguments + (["--still"] if still else [])) == 0
    with np.load(tmp_path / "out.npz") as made:
        frames = made["vertices"]
    rest = bundled().neutral.astype(float)
    wanted = rest if still else rest @ turns[-1].T
    assert np.linalg.norm(frames[-1] - wanted, axis=1).max() < 1.0


def test_a_flat_shaded_head_is_driven_without_tearing_and_written_as_it_came(foreign: Path, tmp_path: Path) -> None:
    flat = tmp_path / "flat"
    flat.mkdir()
    for path in foreign.glob("*.obj"):
        lines = path.read_text().splitlines()
        vertices = [line for line in lines if line.startswith("v ")]
        corners = [int(cell) for line in lines if line.startswith("f ") for cell in line.split()[1:]]
        faces = [f"f {n} {n + 1} {n + 2}" for n in range(1, len(corners), 3)]
        (flat / path.name).write_text("\n".join([*(vertices[corner - 1] for corner in corners), *faces]) + "\n")
    assert cli.run(["drive", str(demo.BUNDLED), "--mesh", str(flat), "-o", str(tmp_path / "out.npz")]) == 0
    corners = bundled().triangles.ravel()
    with np.load(tmp_path / "out.npz") as made:
        frames, faces = made["vertices"], made["faces"]
    assert frames.shape[1] == len(corners) and len(faces) == len(bundled().triangles)
    for vertex in np.unique(corners)[::400]:
        assert not np.ptp(frames[:, corners == vertex], axis=1).any()
