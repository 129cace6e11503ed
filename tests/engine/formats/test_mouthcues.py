from __future__ import annotations

import json
from pathlib import Path

from engine.formats.cues import read_cues
from engine.speech.visemes import Cue
from tests.engine.formats.grids import written

RHUBARB = [Cue(0.0, 0.1, "sil"), Cue(0.1, 0.35, "mbp"), Cue(0.35, 0.35, "aa")]


def test_mouth_cues_in_three_forms(tmp_path: Path) -> None:
    tsv = "0.00\tX\n0.10\tA\n0.35\tD\n"
    rows = [{"start": 0.0, "end": 0.1, "value": "X"}, {"start": 0.1, "end": 0.35, "value": "A"}]
    rows += [{"start": 0.35, "end": 0.35, "value": "D"}]
    tags = "".join(f'<mouthCue start="{r["start"]}" end="{r["end"]}">{r["value"]}</mouthCue>' for r in rows)
    xml = f"<rhubarbResult><mouthCues>{tags}</mouthCues></rhubarbResult>"
    for ending, text in ((".tsv", tsv), (".json", json.dumps({"mouthCues": rows})), (".xml", xml)):
        assert read_cues(written(tmp_path, text, ending)) == RHUBARB


def test_a_mouth_shape_that_is_none_leaves_its_stretch_out(tmp_path: Path) -> None:
    heard: list[str] = []
    assert read_cues(written(tmp_path, "0\tA\n1\tQ\n2\tD\n3\tX", ".tsv"), heard.append) == [
        Cue(0, 1, "mbp"),
        Cue(2, 3, "aa"),
        Cue(3, 3, "sil"),
    ]
    assert len(heard) == 1 and "'Q'" in heard[0]


def test_a_cue_that_ends_before_it_begins_is_left_out_with_a_sentence(tmp_path: Path) -> None:
    heard: list[str] = []
    assert read_cues(written(tmp_path, "5\tA\n1\tB\n2\tC", ".tsv"), heard.append) == [Cue(1, 2, "sz"), Cue(2, 2, "eh")]
    assert len(heard) == 1 and "cue 1" in heard[0]
