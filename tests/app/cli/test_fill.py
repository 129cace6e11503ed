from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from app import cli
from engine.formats import read_take, write_take
from engine.lab.performer import demo
from engine.take import Take

TAKE = str(demo.BUNDLED)


def test_a_filled_span_passes_its_pins_and_leaves_the_rest(tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    code = cli.run(
        [
            "fill",
            TAKE,
            "--frames",
            "60:130",
            "--pin",
            "90:jawOpen=.5,mouthClose=0",
            "--pin",
            f"100:{TAKE}@3",
            "-o",
            str(out),
        ]
    )
    assert code == 0
    source, made = read_take(demo.BUNDLED), read_take(out)
    outside = np.r_[0:60, 130 : len(source)]
    np.testing.assert_array_equal(made.weights[outside], source.weights[outside])
    assert made.curve("jawOpen")[90] == pytest.approx(0.5, abs=1e-6)
    np.testing.assert_allclose(made.weights[100], source.weights[3], atol=1e-6)


def test_lost_runs_are_filled_in_several_variants(tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    assert cli.run(["fill", TAKE, "--lost", "--variants", "2", "-o", str(out)]) == 0
    first, second = (read_take(tmp_path / f"out_{index}.csv") for index in (1, 2))
    assert not first.lost.any() and np.abs(first.weights - second.weights).max() > 0


def test_visemes_controls_and_a_guide_steer(tmp_path: Path) -> None:
    out, cues = tmp_path / "out.csv", tmp_path / "cues.tsv"
    cues.write_text("2.0\tA\n2.5\tD\n4.0\tX\n")
    steer = ["--visemes", str(cues), "--control", "lips_vertical=60:2,80:9", "--guide", TAKE, "--guide-offset", "5"]
    assert cli.run(["fill", TAKE, "--frames", "60:130", *steer, "-o", str(out)]) == 0


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ([], "Say what to fill"),
        (["--frames", "40:60", "--lost"], "Say what to fill"),
        (["--frames", "40:9999"], "not within the take"),
        (["--frames", "40:41"], "one frame"),
        (["--frames", "0:278"], "whole take"),
        (["--frames", "40:60", "--frames", "50:80"], "overlap"),
        (["--frames", "40:60", "--pin", "70:jawOpen=.2"], "outside the span"),
        (["--frames", "40:60", "--pin", "50:jawOpen=.2", "--pin", "50:jawOpen=.4"], "different values"),
        (["--frames", "40:60", "--pin", "jawOpen=.2"], "not a pin"),
        (["--frames", "40:60", "--pin", "50:jawOpen=wide"], "not a number"),
        (["--frames", "40:60", "--pin", f"50:{TAKE}@999"], "has no frame 999"),
        (["--frames", "40:60", "--visemes", TAKE], "not a kind of file"),
        (["--frames", "40:60", "--control", "lips=3"], "no control called"),
        (["--frames", "40:60", "--control", "lips_vertical"], "not a control curve"),
        (["--frames", "40:60", "--guide", TAKE, "--guide-offset", "999"], "does not cover"),
        (["--frames", "40:60", "--region", "nose"], "no region"),
    ],
)
def test_mistakes_are_one_sentence(tmp_path: Path, arguments: list[str], says: str, capsys) -> None:
    out = tmp_path / "out.csv"
    frames = len(read_take(demo.BUNDLED))
    arguments = [text.replace("0:278", f"0:{frames}") for text in arguments]
    assert cli.run(["fill", TAKE, *arguments, "-o", str(out)]) == 2
    said = capsys.readouterr().err
    assert says in said and said.count("\n") == 1 and not out.exists()


def test_a_guide_of_another_rate_is_refused_and_an_unknown_viseme_guides_nothing(tmp_path: Path, capsys) -> None:
    source, out = read_take(demo.BUNDLED), tmp_path / "out.csv"
    write_take(Take(source.weights, 60.0), tmp_path / "fast.csv")
    (tmp_path / "cues.tsv").write_text("1.0\tQ\n2.0\tX\n")
    fill = ["fill", TAKE, "--frames", "40:60", "-o", str(out)]
    assert cli.run([*fill, "--guide", str(tmp_path / "fast.csv")]) == 2
    said = capsys.readouterr().err
    assert "60 frames per second" in said and said.count("\n") == 1 and not out.exists()
    assert cli.run([*fill, "--visemes", str(tmp_path / "cues.tsv")]) == 0
    said = capsys.readouterr().err
    assert "'Q'" in said and "1 stretch stays unguided" in said and said.count("\n") == 1 and out.exists()
