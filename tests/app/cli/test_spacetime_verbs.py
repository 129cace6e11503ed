from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from app import cli
from engine.character import bundled
from engine.formats import read_take
from engine.formats.markers import Markers, write
from engine.performance import demo
from engine.spacetime.layout import standard
from engine.take import SHAPE_INDEX

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
