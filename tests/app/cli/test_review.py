from __future__ import annotations

import json
import shutil
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
import soundfile

from app import cli
from engine.formats import read_take, write_take
from engine.lab.performer import demo
from engine.project import Contents, Marks, create
from engine.quality import Dismissal
from engine.review.pairs import flags
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


def test_check_reports_to_a_pipeline_by_its_exit_code(
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
    assert cli.run(["review", "--queue", str(queue), "-o", str(tmp_path / "out"), "--no-pictures"]) == 2
    assert "2 pairs, 1 of them unread" in capsys.readouterr().out
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["a_edited.html", "index.html"]


@pytest.mark.parametrize(
    "arguments",
    [[], [DEMO, "-o", "x.html"], [DEMO, DEMO], [DEMO, DEMO, "-o", "x.txt"], ["--queue", "nowhere", "-o", "x"]],
)
def test_what_cannot_be_reviewed_is_one_sentence(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["review", *arguments]) == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1


def test_flags_and_notes_are_written_for_people_and_for_editors(edited: Path, tmp_path: Path) -> None:
    names = {"--findings": "found.csv", "--markers": "cut.edl", "-o": "report.html"}
    out = [word for option, name in names.items() for word in (option, str(tmp_path / name))]
    assert cli.run(["review", DEMO, str(edited), "--no-pictures", *out]) == 0
    assert "spike" in (tmp_path / "found.csv").read_text() and "FCM: NON-DROP" in (tmp_path / "cut.edl").read_text()
    assert cli.run(["review", DEMO, str(edited), "--findings", str(tmp_path / "found.json")]) == 0
    assert json.loads((tmp_path / "found.json").read_text())["flags"][0]["kind"]


def test_takes_of_two_people_are_distinguished_and_the_report_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    take = read_take(demo.BUNDLED)
    other = np.random.default_rng(0).random((len(take), 52)) * 0.4
    write_take(take.with_weights(other), tmp_path / "other.csv")
    out = tmp_path / "report.html"
    assert cli.run(["review", DEMO, str(tmp_path / "other.csv"), "-o", str(out), "--no-pictures"]) == 1
    told = capsys.readouterr().err.strip()
    assert len(told.splitlines()) == 1 and "do not look like one performance" in told and out.exists()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ([DEMO, "-o", "{out}"], "does not hold what it was made from"),
        ([DEMO, DEMO, "--offset", "1000", "-o", "{out}"], "no frame in common"),
        ([DEMO, "{broken}", "-o", "{out}"], "broken.csv"),
        ([DEMO, "{folder}/none.csv", "-o", "{out}"], "none.csv"),
        ([DEMO, DEMO, "--findings", "{folder}/x.doc"], "x.doc"),
        ([DEMO, DEMO, "--markers", "{folder}/x.json"], "x.json"),
        (["--queue", "{folder}", "-o", "{folder}/q", "--findings", "{folder}/x.csv"], "reports alone"),
        (["--queue", "{folder}/empty", "-o", "{folder}/q"], "no pairs"),
    ],
)
def test_bad_input_leaves_everything_as_it_was(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], sentence: str
) -> None:
    places = {"out": tmp_path / "report.html", "broken": tmp_path / "broken.csv", "folder": tmp_path}
    places["out"].write_text("an older report")
    places["broken"].write_text("x")
    (tmp_path / "empty").mkdir()
    before = {path: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()}
    assert cli.run(["review", *(word.format(**places) for word in arguments)]) == 2
    told = capsys.readouterr().err.strip()
    assert len(told.splitlines()) == 1 and sentence in told
    assert {path: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()} == before


def test_a_dismissed_flag_does_not_fail_a_pipeline_and_a_kind_by_name_is_looked_for(
    tmp_path: Path, edited: Path
) -> None:
    take = read_take(edited)
    (spike,) = (flag for flag in flags(edited) if flag.kind == "spike")
    who = Dismissal(**asdict(spike), author="Ada", time="2026-01-02T03:04:05+00:00", why="she does that")
    for name, marks in (("open", Marks()), ("dismissed", Marks(dismissals=(who,)))):
        create(tmp_path / f"{name}.retake", Contents(take, (), 0, marks)).close()
    assert cli.run(["check", str(tmp_path / "open.retake"), "--fail-on", "spike"]) == 1
    assert cli.run(["check", str(tmp_path / "dismissed.retake"), "--fail-on", "spike"]) == 0
    names = ("mouthStretchLeft", "mouthStretchRight", "mouthFrownLeft", "mouthLeft", "mouthUpperUpRight", "jawOpen")
    weights = take.weights.copy()
    weights[100:110, [SHAPE_INDEX[name] for name in names]] = 1.0
    write_take(take.with_weights(weights), tmp_path / "wild.csv")
    assert cli.run(["check", str(tmp_path / "wild.csv"), "--fail-on", "unlike"]) == 1
    assert "unlike" not in {flag.kind for flag in flags(tmp_path / "wild.csv")}
