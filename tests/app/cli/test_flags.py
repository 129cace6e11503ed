from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
import soundfile

from app import cli
from engine import project
from engine.controls import ALL_CONTROLS, CONTROL_INDEX, measure
from engine.formats import read_take, write_take
from engine.lab.performer import demo
from engine.project import Contents, Edit
from engine.take import SHAPE_INDEX, Take

DEMO = str(demo.BUNDLED)


def rows(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(text.splitlines()))


def test_flags_go_to_the_screen_or_to_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["flags", DEMO]) == 0
    shown = capsys.readouterr().out
    (lost,) = rows(shown)
    assert (lost["kind"], lost["frame"], lost["stop"]) == ("lost", "252", "276")
    assert cli.run(["flags", DEMO, "-o", str(tmp_path / "flags.csv")]) == 0
    assert (tmp_path / "flags.csv").read_text(encoding="utf-8") == shown
    assert "1 flag;" in capsys.readouterr().out


def test_expected_contacts_come_from_visemes_and_the_original(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    take = read_take(demo.BUNDLED)
    wide = int(np.argmax(measure(take.weights[:200])[:, CONTROL_INDEX["lips_vertical"]]))
    cues = tmp_path / "cues.tsv"
    cues.write_text(f"{wide / take.fps - 1:.3f}\tA\n{wide / take.fps - 0.9:.3f}\tX\n", encoding="utf-8")
    assert cli.run(["flags", DEMO, "--visemes", str(cues), "--visemes-offset", "0.95"]) == 0
    (found,) = [row for row in rows(capsys.readouterr().out) if row["kind"] == "open"]
    assert abs(int(found["frame"]) - wide) <= 2
    weights = take.weights.copy()
    weights[:200, SHAPE_INDEX["jawOpen"]] += 0.5
    opened = tmp_path / "opened.csv"
    write_take(Take(weights=weights, fps=take.fps, lost=take.lost), opened)
    assert cli.run(["flags", str(opened), "--original", DEMO]) == 0
    assert [row for row in rows(capsys.readouterr().out) if row["kind"] == "open"]


def test_a_project_lists_targets_that_were_not_reached(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    take = read_take(demo.BUNDLED)
    asked = np.full((5, len(ALL_CONTROLS)), np.nan)
    asked[:, 0] = 60.0
    edit = Edit("drag", "drag lips apart", 100, take.weights[100:105], asked)
    project.create(tmp_path / "a.retake", Contents(take, (edit,), 1)).close()
    assert cli.run(["flags", str(tmp_path / "a.retake")]) == 0
    (missed,) = [row for row in rows(capsys.readouterr().out) if row["kind"] == "missed"]
    assert (missed["frame"], missed["stop"]) == ("100", "105") and "60.0 mm was asked" in missed["sentence"]


def test_bad_input_is_one_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    short = tmp_path / "short.csv"
    write_take(Take(weights=read_take(demo.BUNDLED).weights[:9], fps=30.0), short)
    for arguments in (
        ["flags", DEMO, "--original", str(short)],
        ["flags", "none.csv"],
        ["flags", DEMO, "--visemes", DEMO],
    ):
        assert cli.run(arguments) == 2
        said = capsys.readouterr().err
        assert said.count("\n") == 1 and "Traceback" not in said


def test_the_sound_shows_that_a_take_is_too_short(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    take = read_take(demo.BUNDLED)
    sound = tmp_path / "sound.wav"
    soundfile.write(sound, np.zeros(round(8_000 * (take.duration_s + 1.0))), 8_000)
    assert cli.run(["flags", DEMO, "--audio", str(sound)]) == 0
    (short,) = [row for row in rows(capsys.readouterr().out) if row["kind"] == "short"]
    assert "1.00 s" in short["sentence"]
    assert cli.run(["flags", DEMO, "--audio", str(sound), "--audio-offset", "-1.0"]) == 0
    assert not [row for row in rows(capsys.readouterr().out) if row["kind"] == "short"]
