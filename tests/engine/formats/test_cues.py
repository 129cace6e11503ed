from __future__ import annotations

import contextlib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.errors import FormatError
from engine.formats.cues import read_cues
from engine.speech.lane import attached
from engine.speech.visemes import NAMES, Cue, class_of, classes_over
from tests.engine.formats.grids import SHORT, grid, tier, written


@pytest.mark.parametrize(
    ("ending", "content", "says"),
    [
        (".wav", b"", "not a kind of file"),
        (".textgrid", b"", "not a TextGrid"),
        (".textgrid", b"\xff\xfe\x00", "not a text file"),
        (".textgrid", SHORT[:60], "ends in the middle"),
        (".textgrid", SHORT[: SHORT.index('"IntervalTier"')], "holds no intervals"),
        (".textgrid", '"ooTextFile" "TextGrid" ' + "[" * 40_000, "ends in the middle"),
        (".textgrid", '"ooTextFile" "Sound" 1 2', "not a TextGrid"),
        (".tsv", "hello", "not a list of times"),
        (".tsv", "x\tA", "no start, end and shape in any"),
        (".tsv", "", "holds no mouth cues"),
        (".json", '{"mouthCues": [{"start": 1' + "0" * 300 + ', "end": 2, "value": "A"}]}', "no start, end and shape"),
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


def classes(cues: list[Cue]) -> list[str]:
    return [NAMES[class_of(cue.label)] for cue in cues]


@pytest.mark.parametrize(
    ("name", "labels", "expected"),
    [
        ("phones", "pʰ t̪ n̩ t͡ʃ ɑ̃ ɫ̩ ç y aː ˈa cʷ", "mbp tn tn sh aa tn kg uw aa aa kg"),
        ("speaker 1 - phones", "S T AA1 SH Y JH", "sz tn aa sh iy jh"),
        ("phones", "s ih h# dcl hv ax-h y", "sz iy sil tn kg ah iy"),
        ("ORT-MAU", "S T N <p:> tS a~ P", "sh th kg sil sh aa fv"),
        ("phones", "S t @ r\\ V: I", "sh tn ah r ah iy"),
        ("MAU", "ʃ ə p", "sh ah mbp"),
        ("MAU", "E+ h 2: <nib>", "eh kg ow sil"),
        ("phones", "ʈʂ ɖʐ ʂ a˥˩", "sh jh sh aa"),
        ("phones", "M_B AA1_I hh_I ow_E SIL_S", "mbp aa kg ow sil"),
        ("visemes", "sil mbp aa tn kg", "sil mbp aa tn kg"),
    ],
    ids=["ipa", "arpabet", "timit", "maus", "x-sampa", "maus in ipa", "maus in dutch", "mandarin", "kaldi", "classes"],
)
def test_alphabets_are_told_apart_by_case_and_tier(tmp_path: Path, name: str, labels: str, expected: str) -> None:
    heard: list[str] = []
    words = tier("hello", "a", name="words")
    cues = read_cues(written(tmp_path, grid(words, tier(*labels.split(), name=name)), ".TextGrid"), heard.append)
    assert classes(cues) == expected.split() and not heard
    assert attached(cues, "x").classes.tolist() == [NAMES.index(one) for one in expected.split()]


def test_an_unknown_label_leaves_its_stretch_out_and_is_named_once(tmp_path: Path) -> None:
    heard: list[str] = []
    cues = read_cues(written(tmp_path, grid(tier("M", "??", "AA1", "??", "zzz")), ".TextGrid"), heard.append)
    assert [cue.start_s for cue in cues] == [0, 2]
    assert len(heard) == 1 and "'??', 'zzz'" in heard[0] and "3 of 5 stretches stay unguided" in heard[0]
    unguided = classes_over(cues, frames=5, fps=1.0)
    assert unguided.tolist() == [NAMES.index("mbp"), -1, NAMES.index("aa"), -1, -1]


def test_words_alone_are_read_and_guide_nothing(tmp_path: Path) -> None:
    heard: list[str] = []
    assert read_cues(written(tmp_path, grid(tier("hello", "world", name="words")), ".TextGrid"), heard.append) == []
    assert len(heard) == 1 and "hello" in heard[0]


@pytest.mark.parametrize("ending", [".textgrid", ".json", ".xml", ".tsv"])
def test_brackets_quotes_and_depth_take_no_time_to_speak_of(tmp_path: Path, ending: str) -> None:
    """A pattern that looks again from each of n places takes n²: a minute here, and no test would end."""
    for piece in ("[", '"', '""a', "!", "<", "{", "\t", "0 ", '"IntervalTier" '):
        text = '"ooTextFile" "TextGrid" ' + piece * (400_000 // len(piece))
        with contextlib.suppress(FormatError):
            read_cues(written(tmp_path, text, ending))
