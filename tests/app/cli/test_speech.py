from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import soundfile

from app import cli
from engine.formats.cues import read_cues
from engine.lab.performer import demo
from engine.speech import hearing
from engine.speech.transcript import Said, Transcript
from engine.speech.visemes import Cue

PHONES = (Cue(0.0, 0.1, "M"), Cue(0.1, 0.3, "AA"))
FOUND = Transcript((Said("ma", 0.0, 0.3, 0.1, PHONES),), PHONES, 0.3)


@pytest.fixture
def sound(tmp_path: Path) -> Path:
    soundfile.write(tmp_path / "a.wav", np.zeros(16_000), 16_000)
    return tmp_path / "a.wav"


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[dict]:
    held: list[dict] = []

    def transcribed(samples, rate, **given) -> Transcript:
        held.append({"length": len(samples), "rate": rate, **given})
        return FOUND

    monkeypatch.setattr(hearing, "transcribed", transcribed)
    return held


def test_what_is_said_is_written_and_doubts_are_told(
    tmp_path: Path, sound: Path, asked: list[dict], capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.txt").write_text("Ma")
    line = ["speech", str(sound), "--text", str(tmp_path / "a.txt"), "--take", str(demo.BUNDLED)]
    assert cli.run([*line, "-o", str(tmp_path / "a.TextGrid")]) == 0
    told = capsys.readouterr()
    assert "aligned 1 word, 2 phones" in told.out and "by chance" in told.out
    assert "hardly what is said: 1 of 1" in told.err
    assert asked[0]["text"] == "Ma" and asked[0]["length"] == asked[0]["rate"] == 16_000
    assert [cue.label for cue in read_cues(tmp_path / "a.TextGrid")] == ["M", "AA"]


def test_a_recording_outside_the_take_is_one_sentence(
    tmp_path: Path, sound: Path, asked: list[dict], capsys: pytest.CaptureFixture[str]
) -> None:
    line = ["speech", str(sound), "--take", str(demo.BUNDLED), "--audio-offset", "1e6", "-o", str(tmp_path / "a.csv")]
    assert cli.run(line) == 2
    assert "does not lie in the take" in capsys.readouterr().err


def test_silence_and_a_missing_program_are_one_sentence(
    tmp_path: Path, sound: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run(["speech", str(sound), "-o", str(tmp_path / "b.csv")]) == 2
    assert capsys.readouterr().err.count("\n") == 1 and not (tmp_path / "b.csv").exists()
