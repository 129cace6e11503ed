from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from app import cli
from engine.controls import ALL_INDEX, measure
from engine.extended import bundled_face
from engine.formats import read_take, write_take
from engine.lab.performer import demo
from engine.take import Take


def test_edit_writes_a_take_with_the_lips_closed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out.csv"
    arguments = [
        "edit",
        str(demo.BUNDLED),
        "--control",
        "lips_vertical",
        "--frames",
        "70:90",
        "--set",
        "0",
        "-o",
        str(out),
    ]
    assert cli.run(arguments) == 0
    before, after = read_take(demo.BUNDLED), read_take(out)
    assert measure(after.weights)[70:90, 0].max() <= 2.0
    np.testing.assert_array_equal(after.weights[:40], before.weights[:40])
    np.testing.assert_array_equal(after.weights[130:], before.weights[130:])
    assert "wrote" in capsys.readouterr().out


def test_edit_says_what_could_not_be_reached_and_why(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = [tmp_path / name for name in ("exact.csv", "as_recorded.csv")]
    arguments = ["edit", str(demo.BUNDLED), "--control", "lips_vertical", "--frames", "70:90", "--set"]
    assert cli.run([*arguments, "150", "--exact", "-o", str(out[0])]) == 0
    assert "of 150.0 asked: " in (told := capsys.readouterr().out) and "limit" in told
    assert cli.run([*arguments, "80", "--believability", "1", "-o", str(out[1])]) == 0
    assert "recordings go further; --exact goes there" in capsys.readouterr().out
    lips = [measure(read_take(path).weights)[70:90, 0].max() for path in out]
    assert lips[0] > lips[1] + 2.0


@pytest.mark.parametrize("control", ["brow_inner", "corner_height_left", "gaze_horizontal", "jaw_sideways"])
def test_edit_changes_further_controls(tmp_path: Path, control: str, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out.csv"
    arguments = ["edit", str(demo.BUNDLED), "--control", control, "--frames", "70:90", "--add", "2", "-o", str(out)]
    assert cli.run(arguments) == 0
    unit = "degrees" if control.startswith("gaze") else "mm"
    assert f"{unit}\n" in capsys.readouterr().out
    before, after = (bundled_face().measure(read_take(path).weights) for path in (demo.BUNDLED, out))
    np.testing.assert_allclose((after - before)[70:90, ALL_INDEX[control]], 2.0, atol=0.05)


def test_info_prints_one_json_object(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["info", str(demo.BUNDLED), "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    assert "lips_vertical" in {row["name"] for row in shown["rows"]}


def test_render_draws_a_picture_and_a_movie(tmp_path: Path) -> None:
    short = tmp_path / "short.csv"
    take = read_take(demo.BUNDLED)
    write_take(Take(weights=take.weights[:5], fps=take.fps), short)
    for name, start in (("a.png", b"\x89PNG"), ("a.mp4", b"\0\0\0")):
        assert (
            cli.run(["render", str(short), "-o", str(tmp_path / name), "--compare", str(short), "--size", "128"]) == 0
        )
        assert (tmp_path / name).read_bytes().startswith(start)


def hostile(folder: Path) -> dict[str, Path]:
    whole = demo.BUNDLED.read_bytes()
    header, first, *_ = whole.split(b"\n")
    cells = first.split(b",")
    contents = {
        "truncated.csv": whole[: len(whole) // 2 + 7],
        "nan.csv": header + b"\n" + b",".join([*cells[:2], b"nan", *cells[3:]]) + b"\n",
        "text.csv": "Lieber Ärger, viel Text\nund noch mehr".encode(),
        "wide.csv": b",".join(b"c%d" % index for index in range(10**6)) + b"\n1\n",
        "empty.csv": b"",
        "picture.csv": b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 40,
        "picture.png": b"\x89PNG\r\n\x1a\n",
    }
    for name, content in contents.items():
        (folder / name).write_bytes(content)
    return {name: folder / name for name in contents}


@pytest.mark.parametrize(
    "name", ["truncated.csv", "nan.csv", "text.csv", "wide.csv", "empty.csv", "picture.csv", "picture.png", "none.csv"]
)
def test_bad_input_is_one_sentence_and_exit_code_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    path = hostile(tmp_path).get(name, tmp_path / name)
    assert cli.run(["info", str(path)]) == 2
    told = capsys.readouterr()
    assert told.out == "" and name in told.err
    assert len(told.err.strip().splitlines()) == 1 and len(told.err) < 300 and "Traceback" not in told.err


def test_a_take_of_one_frame_is_fine(tmp_path: Path) -> None:
    path, out = tmp_path / "one.csv", tmp_path / "out.csv"
    write_take(Take(weights=np.zeros((1, 52)), fps=30.0), path)
    assert cli.run(["info", str(path)]) == 0
    assert (
        cli.run(["edit", str(path), "--control", "lips_vertical", "--frames", "0:1", "--add", "5", "-o", str(out)]) == 0
    )
    assert measure(read_take(out).weights)[0, 0] > 2.0


@pytest.mark.parametrize(
    "arguments",
    [
        ["evaluate", "nonsense"],
        ["train", "nonsense"],
        ["build", "nonsense"],
        ["edit", str(demo.BUNDLED), "--control", "x", "--frames", "0:1", "--set", "0", "-o", "x.csv"],
        ["edit", str(demo.BUNDLED), "--control", "lips_vertical", "--frames", "0:1", "-o", "x.csv"],
        ["edit", str(demo.BUNDLED), "--control", "lips_vertical", "--frames", "0:1", "--set", "nan", "-o", "x.csv"],
        ["render", str(demo.BUNDLED), "-o", "x.gif"],
        ["render", str(demo.BUNDLED), "-o", "x.png", "--frame", "99999"],
        ["no-such-command"],
    ],
)
def test_a_wrong_request_exits_with_2(arguments: list[str]) -> None:
    assert cli.run(arguments) == 2


def test_a_folder_that_cannot_be_written_is_a_sentence(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["edit", str(demo.BUNDLED), "--control", "lips_vertical", "--frames", "0:1", "--set", "0"]
    assert cli.run([*arguments, "-o", "/proc/none/out.csv"]) == 2
    assert "could not be written" in capsys.readouterr().err
