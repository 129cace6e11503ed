"""Numbers and names that nobody means: one sentence, exit code 2, and nothing written."""

from __future__ import annotations

from pathlib import Path

import pytest

from app import cli
from engine.lab.performer import demo

TAKE = str(demo.BUNDLED)
EDIT = ["edit", TAKE, "--control", "lips_vertical", "--frames", "3:9"]
FILL = ["fill", TAKE, "--frames", "3:40"]
PIN = ["pin", TAKE, "--frame", "5", "--range", "3:9"]
MANY = "9" * 5000


@pytest.mark.parametrize(
    "arguments",
    [
        [*EDIT, "--set", "1e308"],
        [*EDIT, "--scale", "-1e308"],
        [*EDIT, "--add", "nan"],
        [*PIN, "--weights", "jawOpen=1e308"],
        [*PIN, "--control", "lips_vertical=1e308"],
        ["smooth", TAKE, "--cutoff", "1e-320"],
        ["retarget", TAKE, "--alpha", "1e308"],
        ["retarget", TAKE, "--closure", "1e308"],
        [*FILL, "--control", "lips_vertical=1e308"],
        [*FILL, "--control", f"lips_vertical={'x' * 5000}"],
        [*FILL, "--control", "lips_vertical={empty}"],
        [*FILL, "--control", "lips_vertical={folder}"],
        [*FILL, "--visemes", "{said}", "--visemes-offset", "1e308"],
        [*FILL, "--seed", "9" * 25],
        [*FILL, "--pin", f"{MANY}:jawOpen=.5"],
        [*FILL, "--pin", "²:jawOpen=.5"],
        [*FILL, "--pin", f"5:{TAKE}@{MANY}"],
    ],
)
@pytest.mark.filterwarnings("error")
def test_what_nobody_means_is_one_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str]
) -> None:
    (tmp_path / "empty.txt").touch()
    (tmp_path / "said.tsv").write_text("0.0\tA\n1.0\tD\n2.0\tX\n")
    places = {"empty": tmp_path / "empty.txt", "folder": tmp_path, "said": tmp_path / "said.tsv"}
    told = [text.format(**places) if "{" in text else text for text in arguments]
    assert cli.run([*told, "-o", str(tmp_path / "out.csv")]) == 2
    said = capsys.readouterr().err.strip()
    assert said and "Traceback" not in said and "Something went wrong" not in said
    assert not (tmp_path / "out.csv").exists()


@pytest.mark.parametrize("address", [f"127.0.0.1:{MANY}", "127.0.0.1:0", "nowhere", ""])
def test_an_address_that_is_none_is_one_sentence(capsys: pytest.CaptureFixture[str], address: str) -> None:
    assert cli.run(["replay", TAKE, "--to", address]) == 2
    assert "Traceback" not in capsys.readouterr().err


def test_variants_without_a_name_are_refused_before_the_work(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run([*FILL, "--variants", "2", "-o", ""]) == 2
    assert "not a kind of file" in capsys.readouterr().err
