from __future__ import annotations

from pathlib import Path

import pytest

from engine.formats.cues import read_cues
from engine.speech.visemes import Cue
from tests.engine.formats.grids import LONG, SHORT, grid, tier, written

EXPECTED = [Cue(0.0, 0.35, "M"), Cue(0.35, 0.9, "AA1")]


@pytest.mark.parametrize("text", [LONG, SHORT], ids=["long", "short"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_both_forms_of_a_textgrid_in_every_encoding(tmp_path: Path, text: str, encoding: str) -> None:
    assert read_cues(written(tmp_path, text, ".TextGrid", encoding)) == EXPECTED


def test_of_two_tiers_of_one_name_the_first_counts(tmp_path: Path) -> None:
    tier = SHORT[SHORT.index('"IntervalTier"') :]
    twice = SHORT.replace("<exists>\n2", "<exists>\n3") + tier.replace("AA1", "IY")
    assert read_cues(written(tmp_path, twice, ".textgrid")) == EXPECTED


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


def test_a_grid_that_is_cut_off_gives_what_is_there(tmp_path: Path) -> None:
    assert read_cues(written(tmp_path, SHORT[:-12], ".TextGrid")) == EXPECTED[:1]
