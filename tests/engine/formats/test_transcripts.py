from __future__ import annotations

import csv
from pathlib import Path

import pytest

from engine.errors import FormatError
from engine.formats import transcripts
from engine.formats.cues import read_cues
from engine.speech.transcript import Said, Transcript
from engine.speech.visemes import Cue

PHONES = (Cue(0.0, 0.1, "SIL"), Cue(0.1, 0.15, "B"), Cue(0.15, 0.3, "OW"), Cue(0.3, 0.4, "T"), Cue(0.4, 0.5, "SIL"))
TRANSCRIPT = Transcript((Said('"boat', 0.1, 0.4, 0.25, PHONES[1:4]),), PHONES, 0.5)


def test_phones_come_back_out_of_a_textgrid(tmp_path: Path) -> None:
    transcripts.write(TRANSCRIPT, tmp_path / "a.TextGrid")
    heard: list[str] = []
    found = read_cues(tmp_path / "a.TextGrid", heard.append)
    assert [(cue.start_s, cue.stop_s) for cue in found] == [(cue.start_s, cue.stop_s) for cue in PHONES]
    assert [cue.label.upper() for cue in found] == [cue.label for cue in PHONES] and not heard
    assert '"""boat"' in (tmp_path / "a.TextGrid").read_text()


def test_csv_has_a_row_for_each_word_and_phone(tmp_path: Path) -> None:
    transcripts.write(TRANSCRIPT, tmp_path / "a.csv")
    rows = list(csv.DictReader((tmp_path / "a.csv").open()))
    assert [row["tier"] for row in rows] == ["word"] + ["phone"] * 5
    assert rows[0] == {"tier": "word", "start_s": "0.1000", "stop_s": "0.4000", "label": '"boat', "confidence": "0.250"}


def test_another_ending_is_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="not a kind of file"):
        transcripts.write(TRANSCRIPT, tmp_path / "a.txt")
    assert not list(tmp_path.iterdir())
