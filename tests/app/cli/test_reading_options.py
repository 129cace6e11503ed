"""The options that say how a take is read and written: on every command that does so, and carried out by it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click import Command
from typer.main import get_command

from app import cli
from engine.formats import read_take, write_take
from engine.formats.base.reading import Reading
from engine.formats.livelink.sides import exchange
from engine.take import SHAPE_INDEX, SHAPES, Take

READING = (
    "info",
    "edit",
    "render",
    "flags",
    "review",
    "check",
    "fill",
    "smooth",
    "pin",
    "retarget",
    "clean",
    "replay",
    "drive",
)
WRITING = ("edit", "fill", "smooth", "pin", "retarget", "clean")


@pytest.fixture
def given(tmp_path: Path) -> Path:
    """A short take whose mouth goes left while its left side is pulled: by name, and at 30 fps."""
    weights = np.full((60, len(SHAPES)), 0.1)
    weights[:, SHAPE_INDEX["mouthLeft"]] = 0.5
    weights[:, SHAPE_INDEX["jawOpen"]] = np.linspace(0, 0.6, 60)
    write_take(Take(weights, 30.0), tmp_path / "given.csv")
    return tmp_path / "given.csv"


def options(name: str) -> set[str]:
    commands: dict[str, Command] = get_command(cli.build()).commands  # type: ignore[attr-defined]
    return {option for parameter in commands[name].params for option in parameter.opts}


@pytest.mark.parametrize("name", READING)
def test_every_command_that_reads_a_take_has_the_reading_options(name: str) -> None:
    assert {"--fps", "--sides"} <= options(name)


@pytest.mark.parametrize("name", WRITING)
def test_every_command_that_writes_a_take_has_the_writing_options(name: str) -> None:
    assert "--write-sides" in options(name)


def test_no_command_that_takes_a_take_is_forgotten() -> None:
    others = {"evaluate", "bench", "train", "build", "live", "speech", "blind", "character"}
    assert set(get_command(cli.build()).commands) == others | set(READING)  # type: ignore[attr-defined]


def test_info_says_the_rate_the_sides_and_why(given: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["info", str(given)]) == 0
    said = capsys.readouterr().out
    assert "sixtieths of a second" in said and "as the app records" in said
    assert cli.run(["info", str(given), "--fps", "25", "--sides", "as named", "--json"]) == 0
    assert "25 fps" in json.loads(capsys.readouterr().out)["table"]


@pytest.mark.parametrize("command", WRITING[:1] + WRITING[2:4] + WRITING[5:])
def test_rate_and_sides_are_read_and_written_as_asked(given: Path, tmp_path: Path, command: str) -> None:
    extra = {
        "edit": ["--control", "lips_vertical", "--frames", "40:50", "--add", "0"],
        "smooth": ["--cutoff", "6", "--frames", "40:50"],
        "pin": ["--frame", "45", "--range", "40:50", "--weights", "jawOpen=.4"],
        "clean": ["--frames", "40:50"],
    }[command]
    out = tmp_path / "out.csv"
    arguments = [command, str(given), *extra, "-o", str(out), "--fps", "25", "--sides", "named"]
    assert cli.run(arguments) == 0
    before = read_take(given)
    same = read_take(out, reading=Reading(sides="named"))
    np.testing.assert_allclose(same.weights[:20], exchange(before.weights)[:20], atol=1e-9)
    assert cli.run([*arguments, "--write-sides", "recorded"]) == 0
    np.testing.assert_allclose(read_take(out, reading=Reading(sides="recorded")).weights[:20], same.weights[:20])
    assert cli.run([*arguments, "--write-sides", "same"]) == 0
    np.testing.assert_array_equal(read_take(out, reading=Reading(sides="named")).weights, same.weights)


@pytest.mark.parametrize(
    "wrong", [["--fps", "0"], ["--fps", "nan"], ["--fps", "1e9"], ["--sides", "both"], ["--write-sides", "up"]]
)
def test_a_choice_that_cannot_be_is_one_sentence(
    given: Path, tmp_path: Path, wrong: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["smooth", str(given), "--cutoff", "5", "-o", str(tmp_path / "out.csv"), *wrong]
    assert cli.run(arguments) == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1
    assert not (tmp_path / "out.csv").exists()
