from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import soundfile

from app import cli
from engine.formats import read_take, write_take
from engine.lab.performer import demo
from engine.take import SHAPE_INDEX

DEMO = str(demo.BUNDLED)


@pytest.fixture
def edited(tmp_path: Path) -> Path:
    take = read_take(demo.BUNDLED)
    weights = take.weights.copy()
    weights[60:80, SHAPE_INDEX["jawOpen"]] += 0.3 * np.sin(np.linspace(0, np.pi, 22)[1:-1]) ** 2
    weights[200, SHAPE_INDEX["mouthSmileLeft"]] += 0.3
    write_take(take.with_weights(weights), tmp_path / "edited.csv")
    return tmp_path / "edited.csv"


def test_a_report_is_written_with_a_picture_of_each_change(
    edited: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "report.html"
    assert cli.run(["review", DEMO, str(edited), "-o", str(out)]) == 0
    assert "2 changes" in capsys.readouterr().out
    text = out.read_text(encoding="utf-8")
    assert text.count("data:image/png;base64,iVBOR") == 2


def test_changes_and_flags_as_one_json_object(edited: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["review", DEMO, str(edited), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [(change["start"], change["stop"]) for change in told["changes"]] == [(60, 80), (200, 201)]
    assert [flag["kind"] for flag in told["new_flags"]] == ["spike"]


def test_check_tells_a_pipeline_by_its_exit_code(
    edited: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run(["check", str(edited), "--json"]) == 1
    assert not json.loads(capsys.readouterr().out)["ok"]
    assert cli.run(["check", str(edited), "--fail-on", "frozen,impossible"]) == 0
    assert cli.run(["check", str(edited), "--fail-on", "spike"]) == 1
    assert cli.run(["check", str(edited), "--fail-on", "nonsense"]) == 2
    broken = tmp_path / "broken.csv"
    broken.write_text("x")
    capsys.readouterr()
    assert cli.run(["check", str(broken), str(edited), "--json"]) == 2
    first, second = json.loads(capsys.readouterr().out)["takes"]
    assert "error" in first and second["flags"]


def test_check_looks_at_the_sound_beside_a_take(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    take = tmp_path / "take.csv"
    shutil.copy(DEMO, take)
    seconds = read_take(take).duration_s + 1
    soundfile.write(tmp_path / "take.wav", np.zeros(round(8_000 * seconds)), 8_000)
    assert cli.run(["check", str(take), "--fail-on", "short", "--no-sound"]) == 0
    assert cli.run(["check", str(take), "--fail-on", "short"]) == 1
    assert "1 x ends before its sound" in capsys.readouterr().out


def test_a_queue_writes_a_report_of_each_pair_and_goes_on_past_a_broken_one(
    edited: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    queue = tmp_path / "queue"
    queue.mkdir()
    shutil.copy(DEMO, queue / "a.csv")
    shutil.copy(edited, queue / "a_edited.csv")
    shutil.copy(DEMO, queue / "b.csv")
    (queue / "b_edited.csv").write_text("x")
    assert cli.run(["review", "--queue", str(queue), "-o", str(tmp_path / "out"), "--no-pictures"]) == 0
    assert "2 pairs, 1 of them unread" in capsys.readouterr().out
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["a_edited.html", "index.html"]


@pytest.mark.parametrize(
    "arguments",
    [[], [DEMO, "-o", "x.html"], [DEMO, DEMO], [DEMO, DEMO, "-o", "x.txt"], ["--queue", "nowhere", "-o", "x"]],
)
def test_what_cannot_be_reviewed_is_one_sentence(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["review", *arguments]) == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1
