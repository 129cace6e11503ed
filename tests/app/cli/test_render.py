from __future__ import annotations

import shutil
from pathlib import Path

import av
import numpy as np
import pytest
import soundfile
from PySide6.QtWidgets import QApplication

from app import cli
from app.preview import movie
from engine import project
from engine.formats import read_take, write_take
from engine.lab.performer import demo
from engine.take import SHAPE_INDEX, Take

JAW = SHAPE_INDEX["jawOpen"]
FRAMES = 12


@pytest.fixture
def take(tmp_path: Path) -> Path:
    whole = read_take(demo.BUNDLED)
    write_take(Take(whole.weights[60 : 60 + FRAMES], whole.fps), tmp_path / "take.csv")
    return tmp_path / "take.csv"


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> list[list[float]]:
    """Pictures without a renderer; the list fills with what each face's jaw does, picture by picture."""
    jaws: list[list[float]] = []

    def picture(takes: tuple[Take, ...], frame: int, *, height: int) -> np.ndarray:
        jaws.append([float(each.weights[min(frame, len(each) - 1), JAW]) for each in takes])
        return np.zeros((height, len(takes) * height, 3), np.uint8)

    monkeypatch.setattr(movie, "picture", picture)
    monkeypatch.setattr(movie, "difference", lambda *_, height: np.zeros((height, height, 3), np.uint8))
    return jaws


def tracks(path: Path) -> tuple[int, tuple[int, int], list[str]]:
    with av.open(str(path)) as file:
        frames = list(file.decode(file.streams.video[0]))
        sound = [stream.codec_context.name for stream in file.streams.audio]
    return len(frames), (frames[0].width, frames[0].height), sound


def edited_project(folder: Path, take: Path, **marks: object) -> Path:
    original = read_take(take)
    weights = original.weights.copy()
    weights[4:8, JAW] += 0.25
    edit = project.Edit("drag", "open the jaw", 4, weights[4:8], np.full((4, 16), np.nan))
    contents = project.Contents(original, (edit,), 1, project.Marks(**marks))  # type: ignore[arg-type]
    project.create(folder / "p.retake", contents).close()
    return folder / "p.retake"


def test_a_project_is_drawn_beside_its_take_with_sound_and_notes(
    qapp: QApplication, take: Path, shown: list[list[float]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    soundfile.write(tmp_path / "voice.wav", np.full(8_000, 0.1), 16_000)
    note = project.Note(3, "Ada", "2026-01-02T03:04:05+00:00", "<b>wide</b>")
    medium = project.attach(tmp_path / "voice.wav", tmp_path, kind="audio")
    path = edited_project(tmp_path, take, notes=(note,), media=(medium,))
    out = tmp_path / "a.mp4"
    arguments = ["render", str(path), "-o", str(out), "--before-edits", "--burn-in", "--difference", "--size", "64"]
    assert cli.run([*arguments, "--progress"]) == 0
    count, (width, height), sound = tracks(out)
    assert count == FRAMES and sound == ["opus"] and width == 3 * 64 and height > 64
    assert [after - before for before, after in shown] == pytest.approx(
        [0.25 if 4 <= f < 8 else 0.0 for f in range(12)]
    )
    told = [line for line in capsys.readouterr().err.splitlines() if "drawing" in line]
    assert told[-1] == "drawing: 100 %" and len(told) == FRAMES


def test_sound_beside_a_take_is_in_the_movie_unless_it_shall_not_be(
    take: Path, shown: list[list[float]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    soundfile.write(tmp_path / "take.wav", np.zeros(4_000), 8_000)
    out = tmp_path / "a.mp4"
    for extra, expected in ([], ["opus"]), (["--no-sound"], []), (["--codec", "mpeg4"], ["aac"]):
        assert cli.run(["render", str(take), "-o", str(out), "--size", "64", *extra]) == 0
        assert tracks(out)[2] == expected
    (tmp_path / "take.wav").write_bytes(b"RIFF")
    capsys.readouterr()
    assert cli.run(["render", str(take), "-o", str(out), "--size", "64"]) == 0
    assert tracks(out)[2] == [] and "The movie has no sound." in capsys.readouterr().err
    assert cli.run(["render", str(take), "-o", str(out), "--size", "64", "--audio", str(tmp_path / "take.wav")]) == 2


def test_takes_of_two_rates_are_drawn_on_one_clock(take: Path, shown: list[list[float]], tmp_path: Path) -> None:
    slow = read_take(demo.BUNDLED)
    fast = np.stack([np.interp(np.arange(0, 90, 0.5), np.arange(90), curve[:90]) for curve in slow.weights.T], axis=1)
    write_take(Take(slow.weights[:90], 30.0), tmp_path / "slow.csv")
    write_take(Take(fast, 60.0), tmp_path / "fast.csv")
    arguments = ["render", str(tmp_path / "slow.csv"), "--compare", str(tmp_path / "fast.csv"), "--size", "64"]
    assert cli.run([*arguments, "-o", str(tmp_path / "a.mp4")]) == 0
    assert tracks(tmp_path / "a.mp4")[0] == 180
    first, second = np.array(shown).T
    np.testing.assert_allclose(first[:178], second[:178], atol=1e-6)


@pytest.mark.parametrize("extra", [["--difference"], ["--before-edits"], ["--before-edits", "--compare", "{take}"]])
def test_what_cannot_be_drawn_is_one_sentence(
    take: Path, tmp_path: Path, extra: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copy(take, tmp_path / "b.csv")
    arguments = ["render", str(take), "-o", str(tmp_path / "a.mp4"), *(word.format(take=take) for word in extra)]
    assert cli.run(arguments) == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1 and not (tmp_path / "a.mp4").exists()
