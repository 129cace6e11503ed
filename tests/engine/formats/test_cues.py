from __future__ import annotations

import contextlib
import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.errors import FormatError
from engine.formats.cues import read_cues
from engine.speech.visemes import Cue

LONG = """File type = "ooTextFile"
Object class = "TextGrid"

xmin = 0
xmax = 0.9
tiers? <exists>
size = 2
item []:
    item [1]:
        class = "IntervalTier"
        name = "words"
        xmin = 0
        xmax = 0.9
        intervals: size = 1
        intervals [1]:
            xmin = 0
            xmax = 0.9
            text = "say ""ma"" 3"
    item [2]:
        class = "IntervalTier"
        name = "phones"
        xmin = 0
        xmax = 0.9
        intervals: size = 2
        intervals [1]:
            xmin = 0
            xmax = 0.35
            text = "M"
        intervals [2]:
            xmin = 0.35
            xmax = 0.9
            text = "AA1"
"""
SHORT = (
    'File type = "ooTextFile"\nObject class = "TextGrid"\n\n0\n0.9\n<exists>\n2\n"TextTier"\n"bell"\n0\n0.9\n1\n0.2\n"x"\n'
    '"IntervalTier"\n"phones"\n0\n0.9\n2\n0\n0.35\n"M"\n0.35\n0.9\n"AA1"\n'
)
EXPECTED = [Cue(0.0, 0.35, "M"), Cue(0.35, 0.9, "AA1")]


def written(tmp_path: Path, content: str | bytes, ending: str, encoding: str = "utf-8") -> Path:
    path = tmp_path / f"cues{ending}"
    path.write_bytes(content if isinstance(content, bytes) else content.encode(encoding))
    return path


@pytest.mark.parametrize("text", [LONG, SHORT], ids=["long", "short"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_both_forms_of_a_textgrid_in_every_encoding(tmp_path: Path, text: str, encoding: str) -> None:
    assert read_cues(written(tmp_path, text, ".TextGrid", encoding)) == EXPECTED


def test_of_two_tiers_of_one_name_the_first_counts(tmp_path: Path) -> None:
    tier = SHORT[SHORT.index('"IntervalTier"') :]
    twice = SHORT.replace("<exists>\n2", "<exists>\n3") + tier.replace("AA1", "IY")
    assert read_cues(written(tmp_path, twice, ".textgrid")) == EXPECTED


RHUBARB = [Cue(0.0, 0.1, "sil"), Cue(0.1, 0.35, "mbp"), Cue(0.35, 0.35, "aa")]


def test_mouth_cues_in_three_forms(tmp_path: Path) -> None:
    tsv = "0.00\tX\n0.10\tA\n0.35\tD\n"
    rows = [{"start": 0.0, "end": 0.1, "value": "X"}, {"start": 0.1, "end": 0.35, "value": "A"}]
    rows += [{"start": 0.35, "end": 0.35, "value": "D"}]
    tags = "".join(f'<mouthCue start="{r["start"]}" end="{r["end"]}">{r["value"]}</mouthCue>' for r in rows)
    xml = f"<rhubarbResult><mouthCues>{tags}</mouthCues></rhubarbResult>"
    for ending, text in ((".tsv", tsv), (".json", json.dumps({"mouthCues": rows})), (".xml", xml)):
        assert read_cues(written(tmp_path, text, ending)) == RHUBARB


@pytest.mark.parametrize(
    ("ending", "content", "says"),
    [
        (".wav", b"", "not a kind of file"),
        (".textgrid", b"", "ends in the middle"),
        (".textgrid", b"\xff\xfe\x00", "not a text file"),
        (".textgrid", SHORT[: len(SHORT) // 2], "ends in the middle"),
        (".textgrid", SHORT.replace('"phones"', '"bells"'), "no tier of phones: it has 'bell', 'bells'"),
        (".textgrid", SHORT.replace("<exists>\n2", "<exists>\n1e99"), "where a number belongs"),
        (".textgrid", '"ooTextFile" "Sound" 1 2', "not a TextGrid"),
        (".tsv", "hello", "not a list of times"),
        (".tsv", "0.1\tQ", "unknown mouth shape 'Q' in cue 1"),
        (".tsv", "5\tA\n1\tB", "ends before it begins"),
        (".tsv", "x\tA", "no start, end and shape in cue 1"),
        (".json", "[" * 100_000, "holds no mouth cues"),
        (".json", '{"mouthCues": [{"start": null, "end": 1, "value": "A"}]}', "no start, end and shape"),
        (".xml", '<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>', "declares a document type"),
        (".xml", "<a><b></a>", "not well-formed"),
    ],
)
def test_bad_files_get_one_sentence(tmp_path: Path, ending: str, content: str | bytes, says: str) -> None:
    with pytest.raises(FormatError, match=says) as caught:
        read_cues(written(tmp_path, content, ending))
    assert "\n" not in str(caught.value) and f"cues{ending}" in str(caught.value)


@settings(max_examples=150, deadline=None)
@given(content=st.binary(max_size=200), ending=st.sampled_from([".textgrid", ".tsv", ".json", ".xml"]))
def test_any_bytes_are_read_or_refused_in_a_sentence(tmp_path_factory, content: bytes, ending: str) -> None:
    path = written(tmp_path_factory.mktemp("cues"), content, ending)
    with contextlib.suppress(FormatError):
        read_cues(path)
