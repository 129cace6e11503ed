"""No command writes over what it reads, unless told to."""

from __future__ import annotations

import inspect
import shutil
from pathlib import Path

import pytest
import typer

from app import cli
from app.cli.outputs import GOES_ON, OUTPUTS
from engine import project
from engine.formats import read_take
from engine.lab.performer import demo
from engine.project import Contents

PLAIN = {
    "flags": ["flags", "{take}"],
    "edit": ["edit", "{take}", "--control", "lips_vertical", "--frames", "3:9", "--set", "1"],
    "smooth": ["smooth", "{take}", "--cutoff", "5"],
    "clean": ["clean", "{take}"],
    "fill": ["fill", "{take}", "--frames", "3:9"],
    "pin": ["pin", "{take}", "--frame", "5", "--range", "3:9", "--weights", "jawOpen=.2"],
    "render": ["render", "{take}"],
    "retarget": ["retarget", "{take}"],
}


@pytest.fixture
def take(tmp_path: Path) -> Path:
    shutil.copyfile(demo.BUNDLED, tmp_path / "t.csv")
    return tmp_path / "t.csv"


@pytest.mark.parametrize("name", PLAIN)
@pytest.mark.parametrize("through", ["itself", "a link", "another spelling"])
def test_a_take_is_not_replaced_by_what_is_made_of_it(
    take: Path, capsys: pytest.CaptureFixture[str], name: str, through: str
) -> None:
    link = take.with_name("l.csv")
    link.symlink_to(take)
    out = {"itself": take, "a link": link, "another spelling": take.parent / ".." / take.parent.name / "t.csv"}[through]
    before = take.read_bytes()
    assert cli.run([text.format(take=take) for text in PLAIN[name]] + ["-o", str(out)]) == 2
    assert "what this command reads" in " ".join(capsys.readouterr().err.split())
    assert take.read_bytes() == before and link.is_symlink()


@pytest.mark.parametrize(
    "arguments",
    [
        ["fill", "{take}", "--frames", "3:9", "--guide", "{other}"],
        ["fill", "{take}", "--frames", "3:9", "--pin", "5:{other}@3"],  # known only when it is read
        ["flags", "{take}", "--original", "{other}"],
        ["retarget", "{take}", "--method", "manifold", "--labels", "{other}"],
    ],
)
def test_neither_is_anything_else_that_is_read(take: Path, arguments: list[str]) -> None:
    other = take.with_name("other.csv")
    shutil.copyfile(take, other)
    before = other.read_bytes()
    told = [text.format(take=take, other=other) for text in arguments]
    assert cli.run([*told, "-o", str(other)]) == 2
    assert other.read_bytes() == before


def test_a_variant_of_a_fill_does_not_take_the_place_of_the_take(take: Path) -> None:
    first = take.rename(take.with_name("t_2.csv"))
    before = first.read_bytes()
    assert cli.run(["fill", str(first), "--frames", "3:9", "--variants", "2", "-o", str(take)]) == 2
    assert first.read_bytes() == before


def test_overwrite_replaces_it(take: Path) -> None:
    before = read_take(take)
    assert cli.run([*[text.format(take=take) for text in PLAIN["edit"]], "-o", str(take), "--overwrite"]) == 0
    assert (read_take(take).weights != before.weights).any()


def test_a_project_is_not_replaced_by_its_flags(take: Path) -> None:
    path = take.with_name("a.retake")
    project.create(path, Contents(read_take(take))).close()
    before = path.read_bytes()
    assert cli.run(["flags", str(path), "-o", str(path)]) == 2
    assert path.read_bytes() == before


def test_a_device_is_refused_before_the_work(take: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["flags", str(take), "-o", "/dev/null"]) == 2
    assert "not an ordinary file" in capsys.readouterr().err


def test_every_command_that_writes_is_under_the_rule() -> None:
    def commands(app: typer.Typer) -> list[typer.models.CommandInfo]:
        groups = [group.typer_instance for group in app.registered_groups]
        return [*app.registered_commands, *(each for group in groups for each in commands(group))]

    seen = 0
    for command in commands(cli.build()):
        given = set(inspect.signature(command.callback).parameters)
        if OUTPUTS & given and command.callback.__name__ not in GOES_ON:
            assert "overwrite" in given, command.callback.__name__
            seen += 1
    assert seen >= len(PLAIN)
