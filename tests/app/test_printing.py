"""What files and packets say reaches the terminal as text: no markup, no control codes; and nobody prints elsewhere."""

from __future__ import annotations

import ast
import io
import json
import sys
from pathlib import Path

import pytest

from app import cli, printing
from app.cli.tables import show
from engine.formats import write_take
from engine.take import Take

APP = Path(__file__).parents[2] / "app"
HOSTILE = "[final] [bold]x[/bold] :smile: \x1b[2J\x1b]0;owned\x07\r\u202egpj"


@pytest.mark.parametrize(
    "print_it", [printing.say, printing.remark, lambda text: show(text, [{text: text}], as_json=False)]
)
def test_hostile_text_is_printed_as_text(capsys: pytest.CaptureFixture[str], print_it: object) -> None:
    print_it(HOSTILE)  # type: ignore[operator]
    out, err = capsys.readouterr()
    told = out + err
    assert not set("\x1b\x07\r\u202e") & set(told)
    flat = "".join(part for line in told.splitlines() for part in line.strip("│┃ ").split())
    assert "[final]" in flat and "[bold]x[/bold]" in flat and ":smile:" in flat and "\\x1b[2J" in flat


def test_json_is_ascii_and_says_the_same(capsys: pytest.CaptureFixture[str]) -> None:
    printing.as_json({"name": HOSTILE})
    out = capsys.readouterr().out
    assert out.isascii() and "\x1b" not in out and json.loads(out) == {"name": HOSTILE}


def test_a_terminal_of_another_encoding_gets_escapes(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    monkeypatch.setattr(sys, "stdout", stream)
    printing.say("Ärger 顔 \udcff")
    assert stream.buffer.getvalue() == b"\\xc4rger \\u9854 \\udcff\n"  # type: ignore[attr-defined]


def test_names_of_files_reach_the_terminal_as_they_are(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, random_take: Take
) -> None:
    path = tmp_path / "[final]\x1b[31m&[b].csv"
    write_take(random_take, path)
    assert cli.run(["info", str(path)]) == 0
    told = capsys.readouterr().out
    assert "[final]\\x1b[31m&[b].csv" in told and "\x1b" not in told
    assert cli.run(["info", str(tmp_path / "\x1b]0;no\x07.csv")]) == 2
    assert "\x1b" not in (told := capsys.readouterr().err) and "]0;no" in told and "csv could not be read" in told


@pytest.mark.parametrize(
    "arguments", [["\x1b[2J"], ["info", "--\x1b[2J"], ["edit", "\x1b[2J"], ["info", "a", "\x1b[2J"]]
)
def test_words_of_the_command_line_are_printed_as_text(
    capsys: pytest.CaptureFixture[str], arguments: list[str]
) -> None:
    assert cli.run(arguments) == 2
    out, err = capsys.readouterr()
    assert "\x1b" not in out + err and err.strip()


def test_only_one_place_prints() -> None:
    allowed = {APP / "printing.py", APP / "bench" / "measure.py"}  # the latter talks to its own parent process
    found = [
        f"{path.relative_to(APP)}:{node.lineno}"
        for path in APP.rglob("*.py")
        if path not in allowed
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and ast.unparse(node.func) in ("print", "typer.echo", "typer.secho", "Console")
    ]
    assert found == []
