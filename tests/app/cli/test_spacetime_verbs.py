from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app import cli
from engine.assets import SECOND_HEAD
from engine.character import BUNDLED, bundled, save
from engine.editing import Performance
from engine.formats import labels, read_take, write_take
from engine.formats.markers import write
from engine.formats.markers.capture import Markers
from engine.lab.performer import demo
from engine.manifold.retarget import retarget_weights
from engine.spacetime.layout import standard
from engine.take import SHAPE_INDEX, SHAPES, Take
from tests.heads import capture

DEMO = str(demo.BUNDLED)
SMILE = SHAPE_INDEX["mouthSmileLeft"]


def test_pin_writes_a_take_changed_in_its_range_alone(tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    assert (
        cli.run(["pin", DEMO, "--frame", "68", "--weights", "mouthSmileLeft=.8", "--range", "60:80", "-o", str(out)])
        == 0
    )
    before, after = read_take(demo.BUNDLED), read_take(out)
    assert after.weights[68, SMILE] == 0.8
    outside = np.r_[0:60, 80 : len(before)]
    np.testing.assert_array_equal(after.weights[outside], before.weights[outside])


def test_pin_reaches_a_control(tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    assert (
        cli.run(["pin", DEMO, "--frame", "68", "--control", "lips_vertical=9", "--range", "60:80", "-o", str(out)]) == 0
    )
    from engine.controls import CONTROL_INDEX, measure

    assert measure(read_take(out).weights)[68, CONTROL_INDEX["lips_vertical"]] == pytest.approx(9, abs=0.2)


def _markers(tmp_path: Path) -> Path:
    character = bundled()
    layout = standard(character)
    jaw = np.sin(np.linspace(0, np.pi, 30))
    moved = jaw[:, None, None] * layout.deltas(character)[SHAPE_INDEX["jawOpen"]]
    path = tmp_path / "markers.csv"
    write(Markers(layout.rest(character) + moved, layout.names, 30.0), path)
    return path


def test_markers_move_the_bundled_head(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out.csv"
    assert cli.run(["retarget", str(_markers(tmp_path)), "-o", str(out)]) == 0
    jaw = read_take(out).curve("jawOpen")
    np.testing.assert_allclose(jaw, np.sin(np.linspace(0, np.pi, 30)), atol=0.15)
    assert "30 frames" in capsys.readouterr().out


def test_a_landmark_file_says_where_markers_sit(tmp_path: Path) -> None:
    layout = standard(bundled())
    landmarks = tmp_path / "landmarks.csv"
    rows = [f"{name},{vertex}" for name, vertex in zip(layout.names, layout.vertices, strict=True)]
    landmarks.write_text("\n".join(["marker,vertex", *rows[:40]]))
    out = tmp_path / "out.csv"
    assert cli.run(["retarget", str(_markers(tmp_path)), "--landmarks", str(landmarks), "-o", str(out)]) == 0
    assert read_take(out).curve("jawOpen").max() > 0.8


def test_a_take_at_rest_is_a_take_and_no_capture(tmp_path: Path) -> None:
    """Its frames are told apart by its weights, as in the window, and not by markers that it never had."""
    still = Take(np.zeros((30, len(SHAPES))), 30.0)
    write_take(still, tmp_path / "still.csv")
    labels.write(labels.LabelFile({15: {"jawOpen": 0.5}}), tmp_path / "labels.json")
    out = tmp_path / "out.csv"
    arguments = ["--method", "manifold", "--labels", str(tmp_path / "labels.json"), "-o", str(out)]
    assert cli.run(["retarget", str(tmp_path / "still.csv"), *arguments]) == 0
    np.testing.assert_allclose(
        read_take(out).weights, retarget_weights(still, {15: {"jawOpen": 0.5}}).weights, atol=1e-9
    )
    assert Performance(still, bundled()).features is still.weights


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["pin", DEMO, "--frame", "5", "--weights", "jawOpen=.5", "--range", "60:80"], "not within the range"),
        (["pin", DEMO, "--frame", "65", "--weights", "jaw", "--range", "60:80"], "not a name and a number"),
        (["pin", DEMO, "--frame", "65", "--weights", "grin=1", "--range", "60:80"], "no shape called 'grin'"),
        (["pin", DEMO, "--frame", "65", "--range", "60:80"], "no pose"),
        (["retarget", DEMO, "--alpha", "-1"], "alpha must be"),
        (["retarget", "missing.trc"], "could not be read"),
        (["retarget", "missing.csv"], "could not be read"),
    ],
)
def test_what_cannot_be_done_is_one_sentence_and_exit_code_2(
    arguments: list[str], says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run([*arguments, "-o", str(tmp_path / "out.csv")]) == 2
    assert says in capsys.readouterr().err
    assert not (tmp_path / "out.csv").exists()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "empty"),
        ("a,b\n", "does not begin"),
        ("marker,vertex\nnose,-1\n", "row 2"),
        ("marker,vertex\n", "no marker"),
    ],
)
def test_bad_landmark_files_get_one_sentence(
    text: str, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    landmarks = tmp_path / "landmarks.csv"
    landmarks.write_text(text)
    assert cli.run(["retarget", DEMO, "--landmarks", str(landmarks), "-o", str(tmp_path / "o.csv")]) == 2
    assert says in capsys.readouterr().err


def _labels(tmp_path: Path, *frames: int) -> Path:
    """Label frames of the demo take with half its smile and half its jaw."""
    weights, named = read_take(demo.BUNDLED).weights, ("jawOpen", "mouthSmileLeft")
    path = tmp_path / "labels.json"
    rows = {frame: {name: weights[frame, SHAPE_INDEX[name]] / 2 for name in named} for frame in frames}
    labels.write(labels.LabelFile(rows), path)
    return path


def test_labelled_frames_bend_the_whole_take(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["retarget", DEMO, "--method", "manifold", "--suggest", "8"]) == 0
    frames = [int(line) for line in capsys.readouterr().out.split()]
    assert len(set(frames)) == 8
    out = tmp_path / "out.csv"
    arguments = ["retarget", DEMO, "--method", "manifold", "--labels", str(_labels(tmp_path, *frames)), "-o", str(out)]
    assert cli.run(arguments) == 0
    before, after = read_take(demo.BUNDLED), read_take(out)
    for name in ("jawOpen", "mouthSmileLeft"):
        away = np.abs(after.curve(name) - before.curve(name) / 2).mean()
        assert away < 0.1 * np.abs(before.curve(name) / 2).mean()
    untouched = [SHAPE_INDEX["browInnerUp"], SHAPE_INDEX["eyeBlinkLeft"]]
    np.testing.assert_allclose(after.weights[:, untouched], before.weights[:, untouched], atol=1e-3)


def test_suggestions_go_on_from_a_label_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    first = ["retarget", DEMO, "--method", "manifold", "--suggest"]
    assert cli.run([*first, "4"]) == 0
    four = [int(line) for line in capsys.readouterr().out.split()]
    assert cli.run([*first, "2", "--labels", str(_labels(tmp_path, *four[:2]))]) == 0
    assert [int(line) for line in capsys.readouterr().out.split()] == four[2:]


def test_markers_and_labels_move_a_head_of_the_label_file(tmp_path: Path) -> None:
    shutil.copy(BUNDLED, tmp_path / "head.npz")
    labels.write(labels.LabelFile({15: {"jawOpen": 0.5}}, Path("head.npz")), tmp_path / "labels.json")
    out = tmp_path / "out.csv"
    arguments = ["--method", "manifold", "--labels", str(tmp_path / "labels.json"), "-o", str(out)]
    assert cli.run(["retarget", str(_markers(tmp_path)), *arguments]) == 0
    np.testing.assert_allclose(read_take(out).curve("jawOpen"), 0.5 * np.sin(np.linspace(0, np.pi, 30)), atol=0.1)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--labels", "{labels}"], "Add --method manifold"),
        (["--method", "manifold"], "no labelled frames"),
        (["--method", "manifold", "--suggest", "0"], "one suggested frame or more"),
        (["--method", "manifold", "--labels", "{none}"], "could not be read"),
        (["--method", "manifold", "--labels", "{far}"], "Frame 99999 has a label"),
        (["--method", "manifold", "--labels", "{far}", "--suggest", "2"], "Frame 99999 has a label"),
        (["--method", "manifold", "--labels", "{gone}"], "gone.npz is not there"),
    ],
)
def test_unusable_labels_are_one_sentence(
    arguments: list[str], says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    places = {name: tmp_path / f"{name}.json" for name in ("labels", "none", "far", "gone")}
    labels.write(labels.LabelFile({3: {"jawOpen": 1.0}}), places["labels"])
    labels.write(labels.LabelFile({99_999: {"jawOpen": 1.0}}), places["far"])
    labels.write(labels.LabelFile({3: {"jawOpen": 1.0}}, Path("gone.npz")), places["gone"])
    out = tmp_path / "out.csv"
    assert cli.run(["retarget", DEMO, *[part.format(**places) for part in arguments], "-o", str(out)]) == 2
    assert says in capsys.readouterr().err and not out.exists()


def test_markers_of_another_studio_move_the_bundled_head_without_a_landmark_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    weights = np.zeros((30, len(SHAPES)))
    weights[:, SHAPE_INDEX["jawOpen"]] = 0.6 * np.sin(np.linspace(0, np.pi, 30))
    write(capture(weights), tmp_path / "studio.trc")
    out = tmp_path / "out.csv"
    assert cli.run(["retarget", str(tmp_path / "studio.trc"), "-o", str(out)]) == 0
    told = capsys.readouterr().out
    assert "Mouth_Up" in told and "lip_upper" in told and "by place" in told
    jaw = read_take(out).weights[:, SHAPE_INDEX["jawOpen"]]
    assert abs(jaw[15] - 0.6) < 0.2 and jaw[0] < 0.1
    arguments = ["retarget", str(tmp_path / "studio.trc"), "-o", str(out), "--marker", "Mouth_Up=philtrum"]
    assert cli.run(arguments) == 0
    assert "philtrum" in capsys.readouterr().out
    assert cli.run([*arguments[:-1], "Mund=chin"]) == 2
    assert "no marker called 'Mund'" in capsys.readouterr().err


def test_what_a_head_cannot_do_is_not_written_as_its_own(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    head = bundled()
    deltas = head.deltas.copy()
    for name in ("tongueOut", "eyeLookUpLeft", "mouthPucker"):
        deltas[SHAPE_INDEX[name]] = 0.0
    save(replace(head, deltas=deltas, name="poor"), tmp_path / "poor.npz")
    weights = np.zeros((10, len(SHAPES)))
    weights[:, [SHAPE_INDEX[name] for name in ("tongueOut", "eyeLookUpLeft", "eyeLookUpRight")]] = 0.5
    write_take(Take(weights, 30.0), tmp_path / "take.csv")
    out = tmp_path / "out.csv"
    arguments = ["retarget", str(tmp_path / "take.csv"), "--character", str(tmp_path / "poor.npz"), "-o", str(out)]
    assert cli.run(arguments) == 0
    made = read_take(out).weights
    assert not made[:, [SHAPE_INDEX[name] for name in ("tongueOut", "eyeLookUpLeft", "mouthPucker")]].any()
    assert "poor has no eyeLookUpLeft, tongueOut" in capsys.readouterr().out


@pytest.mark.parametrize("command", [["retarget"], ["drive", "--mesh", "head.obj"]])
def test_an_ending_that_cannot_be_written_is_refused_before_anything_is_read(
    command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run([*command, "no_such_take.csv", "-o", str(tmp_path / "t.txt")]) == 2
    said = capsys.readouterr().err
    assert "t.txt is not a kind of file" in said or "t.txt has not an ending" in said


def test_the_second_bundled_head_is_a_target_by_its_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    take = read_take(demo.BUNDLED)
    write_take(Take(take.weights[60:64], take.fps), tmp_path / "take.csv")
    shutil.copy(SECOND_HEAD, tmp_path / "copy.npz")
    for name, out in (("second", "named.csv"), (str(tmp_path / "copy.npz"), "by_file.csv")):
        assert cli.run(["retarget", str(tmp_path / "take.csv"), "--character", name, "-o", str(tmp_path / out)]) == 0
    assert "Moved Second head by 4 frames" in capsys.readouterr().out
    named, by_file = read_take(tmp_path / "named.csv"), read_take(tmp_path / "by_file.csv")
    np.testing.assert_array_equal(named.weights, by_file.weights)
    assert (named.weights != take.weights[60:64]).any()
