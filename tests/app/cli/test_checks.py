from __future__ import annotations

import inspect
import json
from pathlib import Path

import pytest
import typer

from app import cli
from app.cli.checks import OUTPUTS
from engine.lab.performer import demo

TAKE = str(demo.BUNDLED)


def commands(app: typer.Typer):
    yield from (command.callback for command in app.registered_commands)
    for family in app.registered_groups:
        yield from commands(family.typer_instance)


def test_every_command_that_writes_is_in_the_table_and_no_other() -> None:
    found = {
        (command.__name__, name)
        for command in commands(cli.build())
        for name in inspect.signature(command).parameters
        if name in ("out", "record", "key", "findings", "for_editors") and command.__name__ != "score"
    }
    assert found == set(OUTPUTS)


@pytest.mark.parametrize(
    "line",
    [
        ["retarget", TAKE],
        ["pin", TAKE, "--frame", "5", "--range", "0:10", "--weights", "jawOpen=.5"],
        ["edit", TAKE, "--control", "lips_vertical", "--frames", "0:9", "--set", "3"],
        ["clean", TAKE],
        ["smooth", TAKE, "--cutoff", "3"],
        ["fill", TAKE, "--frames", "40:60"],
        ["render", TAKE],
        ["drive", TAKE, "--mesh", "none.glb"],
    ],
    ids=lambda line: line[0],
)
@pytest.mark.parametrize("name", ["t.txt", "no/such/folder/t.csv", "t"])
def test_what_cannot_be_written_is_refused_before_anything_is_read(
    tmp_path: Path, line: list[str], name: str, capsys, monkeypatch
) -> None:
    def work(*_: object, **__: object) -> None:
        raise AssertionError("it was begun")

    monkeypatch.setattr("engine.formats.livelink.read", work)
    monkeypatch.setattr("engine.formats.base.content.require_file", work)
    assert cli.run([*line, "-o", str(tmp_path / name)]) == 2
    assert capsys.readouterr().err.count("\n") == 1 and not list(tmp_path.iterdir())


@pytest.mark.parametrize("number", ["nan", "inf", "-inf"])
@pytest.mark.parametrize(
    "line",
    [
        ["edit", TAKE, "--control", "lips_vertical", "--frames", "0:9", "--set"],
        ["edit", TAKE, "--control", "lips_vertical", "--frames", "0:9", "--scale"],
        ["clean", TAKE, "--strength"],
        ["smooth", TAKE, "--cutoff"],
        ["retarget", TAKE, "--alpha"],
        ["fill", TAKE, "--frames", "40:60", "--visemes-offset"],
        ["fill", TAKE, "--frames", "40:60", "--control", "lips_vertical="],
        ["fill", TAKE, "--frames", "40:60", "--control", "lips_vertical=40:"],
        ["fill", TAKE, "--frames", "40:60", "--pin", "50:jawOpen="],
        ["pin", TAKE, "--frame", "5", "--range", "0:10", "--weights", "jawOpen="],
        ["pin", TAKE, "--frame", "5", "--range", "0:10", "--control", "lips_vertical="],
    ],
    ids=lambda line: f"{line[0]} {line[-1]}",
)
def test_no_command_ignores_a_number_that_is_none(tmp_path: Path, line: list[str], number: str, capsys) -> None:
    last = [line[-1] + number] if line[-1].endswith(("=", ":")) else [line[-1], number]
    assert cli.run([*line[:-1], *last, "-o", str(tmp_path / "out.csv")]) == 2
    assert capsys.readouterr().err.count("\n") == 1 and not list(tmp_path.iterdir())


def test_a_curve_file_without_targets_is_refused(tmp_path: Path, capsys) -> None:
    curve, out = tmp_path / "curve.txt", tmp_path / "out.csv"
    for text in ("nan " * 20, "3 " * 19 + "inf"):
        curve.write_text(text)
        assert cli.run(["fill", TAKE, "--frames", "40:60", "--control", f"lips_vertical={curve}", "-o", str(out)]) == 2
        assert "finite" in capsys.readouterr().err and not out.exists()


def test_labels_for_a_head_elsewhere_ask_for_it(tmp_path: Path, capsys) -> None:
    labels, out = tmp_path / "a.json", tmp_path / "out.csv"
    labels.write_text(json.dumps({"target": "/etc/passwd", "labels": [{"frame": 1, "weights": {"jawOpen": 0.5}}]}))
    assert cli.run(["retarget", TAKE, "--method", "manifold", "--labels", str(labels), "-o", str(out)]) == 2
    said = capsys.readouterr().err
    assert "'passwd', which does not lie beside it" in said and "--character" in said and not out.exists()
