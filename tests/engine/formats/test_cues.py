from __future__ import annotations

import contextlib
import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.errors import FormatError
from engine.formats.cues import read_cues
from engine.speech.lane import attached
from engine.speech.visemes import NAMES, Cue, class_of, classes_over

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


# What aligners and people write, made as small as it can be.
FREE = """"ooTextFile"
"TextGrid"
0 2.3 ! time domain of TextGrid, "quoted" and 7
<exists>
2 tiers
"IntervalTier" "words" ! type and name of tier 1
0 2.3
1 interval coming
0 2.3 "ma"
"IntervalTier" "phones"
0 2.3 ! time domain of tier 2
2 intervals coming
0 0.35 "M" 0.35 9e-1 "AA1" ! interval 3 of "phones"
"""


def tier(*labels: str, name: str = "phones", first_s: float = 0.0) -> str:
    rows = "".join(f'{first_s + at}\n{first_s + at + 1}\n"{label}"\n' for at, label in enumerate(labels))
    return f'"IntervalTier"\n"{name}"\n{first_s}\n{first_s + len(labels)}\n{len(labels)}\n{rows}'


def grid(*tiers: str, kind: str = "ooTextFile", first_s: float = 0.0) -> str:
    head = f'File type = "{kind}"\n"TextGrid"\n\n{first_s}\n{first_s + 9}\n<exists>\n{len(tiers)}\n'
    return head + "".join(tiers)


def classes(cues: list[Cue]) -> list[str]:
    return [NAMES[class_of(cue.label)] for cue in cues]


def test_comments_and_free_standing_values_are_read_as_praat_reads_them(tmp_path: Path) -> None:
    heard: list[str] = []
    assert read_cues(written(tmp_path, FREE, ".TextGrid"), heard.append) == EXPECTED and not heard


@pytest.mark.parametrize("encoding", ["utf-16-le", "utf-16-be", "latin-1", "cp1252"])
def test_a_textgrid_without_a_mark_of_its_encoding(tmp_path: Path, encoding: str) -> None:
    text = LONG.replace("say", "après")
    assert read_cues(written(tmp_path, text, ".TextGrid", encoding)) == EXPECTED


def test_times_before_zero_and_in_powers_of_ten_are_read(tmp_path: Path) -> None:
    text = grid(tier("M", "AA1", first_s=-2.0), kind="ooTextFile short", first_s=-2.0).replace(
        "-1.0\n0.0", "-1.0\n-1e-3"
    )
    assert read_cues(written(tmp_path, text, ".TextGrid"))[0] == Cue(-2.0, -1.0, "M")


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


def test_a_grid_that_is_cut_off_gives_what_is_there(tmp_path: Path) -> None:
    assert read_cues(written(tmp_path, SHORT[:-12], ".TextGrid")) == EXPECTED[:1]


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


@pytest.mark.parametrize("ending", [".textgrid", ".json", ".xml", ".tsv"])
def test_brackets_quotes_and_depth_take_no_time_to_speak_of(tmp_path: Path, ending: str) -> None:
    """A pattern that looks again from each of n places takes n²: a minute here, and no test would end."""
    for piece in ("[", '"', '""a', "!", "<", "{", "\t", "0 ", '"IntervalTier" '):
        text = '"ooTextFile" "TextGrid" ' + piece * (400_000 // len(piece))
        with contextlib.suppress(FormatError):
            read_cues(written(tmp_path, text, ending))
