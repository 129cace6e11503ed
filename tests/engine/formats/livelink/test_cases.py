"""Files of other programs, where they are at hand: each is read with the right rate, and its peaks at their times."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.signal import find_peaks

from engine.formats import read_take, write_take
from engine.formats.base.reading import Reading
from tests.conftest import DATA

CASES = DATA.parent / "cases"


def case(name: str) -> Path:
    path = CASES / name
    if not path.exists():
        pytest.skip("needs the cases of other programs' files")
    return path


@pytest.mark.parametrize("rate", [30, 60])
def test_writers_that_count_frames_have_their_rate_and_their_peaks(rate: int) -> None:
    take = read_take(case(f"01-frame-counter-clock/fll_{rate}.csv"))
    assert take.fps == rate and len(take) == 5 * rate
    peaks = find_peaks(take.curve("jawOpen"), height=0.1)[0] / take.fps
    np.testing.assert_allclose(peaks, np.arange(5) + 0.5, atol=1 / rate)
    assert not any("missed" in notice for notice in take.notices)
    assert any("from timecodes" in notice for notice in take.notices)


def test_rows_that_are_absent_leave_their_time(tmp_path: Path) -> None:
    take = read_take(case("05-edits-lost-on-export/rows_left_out.csv"))
    assert (take.fps, len(take)) == (30.0, 240)
    frames = take.origin.rows
    longest = int(np.argmax(np.diff(frames)))
    assert np.diff(frames)[longest] == 46 and len(frames) == 195
    slow = read_take(case("05-edits-lost-on-export/rows_left_out.csv"), reading=Reading(fps=25.0))
    assert (slow.fps, len(slow)) == (25.0, 240)


@pytest.mark.parametrize("name", ["one_duplicate", "clock_set_back_20ms"])
def test_one_bad_timecode_costs_nothing_but_a_sentence(name: str, tmp_path: Path) -> None:
    path = case(f"08-one-bad-timecode/{name}.csv")
    take = read_take(path)
    assert (take.fps, len(take), take.duration_s) == (60.0, 600, 10.0)
    assert len(take.notices) == 1
    write_take(take, tmp_path / "same.csv")
    assert (tmp_path / "same.csv").read_bytes() == path.read_bytes()
