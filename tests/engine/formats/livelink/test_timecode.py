"""Timecodes of every style are read as the time at which a frame was recorded, and written back letter by letter."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from engine.formats.livelink.timecode import DAY_S, Style, middle, read_times
from tests.engine.formats.livelink.stamps import (
    CASES,
    LABELS,
    REAL_TIME,
    Stamps,
    drop_frames,
    drop_frames_unsaid,
    exact,
    frames,
    length,
    named,
    numbered,
    part_frames,
    plain_thousandths,
    seconds,
    sixtieths,
    stamps,
    thousandths,
    whole_sixtieths,
)

START_S = 35_995.5


@pytest.mark.parametrize(("style", "rate"), CASES, ids=named)
def test_a_timecode_is_the_time_of_its_frame_to_within_what_it_can_tell(style: Stamps, rate: float) -> None:
    rows = list(range(length(style, rate)))
    found = read_times(stamps(style, rate, rows, START_S))
    assert found is not None
    told, times = found
    first = int(START_S * exact(rate))
    labels = style in LABELS
    wanted = (first + np.array(rows)) / (round(rate) if labels else float(exact(rate)))
    slack = 1 / 60 if style is whole_sixtieths else 1.1 * told.quantum_s
    assert np.abs(times - wanted).max() <= slack + 1e-9
    assert (style in REAL_TIME or labels) != told.drop


@pytest.mark.parametrize(("style", "rate"), CASES, ids=named)
def test_a_time_is_written_as_the_timecode_that_it_was_read_from(style: Stamps, rate: float) -> None:
    codes = stamps(style, rate, list(range(length(style, rate))), START_S)
    found = read_times(codes)
    assert found is not None
    told, times = found
    same = [told.write(float(time)) == code for time, code in zip(times, codes, strict=True)]
    assert np.mean(same) > 0.999


@pytest.mark.parametrize("rate", [29.97, 59.94])
def test_dropped_labels_count_every_frame_of_a_day_once(rate: float) -> None:
    base = round(rate)
    style = Style(base=base, decimals=0, drop=True, mark=";")
    per_day = 144 * (600 * base - 9 * (base // 15))
    assert style.day_s == pytest.approx(per_day / float(exact(rate)), rel=1e-12)
    for frame in [*range(0, 40_000, 7), *range(1795, 1805), *range(17_975, 17_990), per_day - 1]:
        code = drop_frames(frame, exact(rate)).encode()
        time_s = float(frame / exact(rate))
        assert style.write(time_s) == code
        fields = np.array([[float(part) for part in code.replace(b";", b":").split(b":")]])
        assert style.seconds(fields)[0] == pytest.approx(time_s, abs=1e-6)
    assert style.write(style.day_s) == b"00:00:00;00"


@pytest.mark.parametrize(
    ("style", "rate", "described"),
    [
        (sixtieths, 30, "timecodes that count sixtieths of a second"),
        (frames, 25, "timecodes that count 25 frames a second"),
        (thousandths, 30, "timecodes that count milliseconds"),
        (seconds, 30, "times in seconds"),
        (plain_thousandths, 30, "times in milliseconds"),
        (drop_frames, 29.97, "drop-frame timecodes of 29.97 fps"),
        (drop_frames_unsaid, 59.94, "drop-frame timecodes of 59.94 fps"),
    ],
)
def test_what_a_style_counts_is_said_in_words(style: Stamps, rate: float, described: str) -> None:
    found = read_times(stamps(style, rate, list(range(length(style, rate))), START_S))
    assert found is not None and found[0].described == described


def test_frame_numbers_have_no_unit_of_time_and_numbers_in_the_decimals_add_none() -> None:
    found = read_times([str(row).encode() for row in range(50)])
    assert found is not None and found[0].base == 0 and found[0].described == "frame numbers"
    assert found[1].tolist() == list(range(50))
    told = read_times(stamps(numbered, 30, list(range(90)), START_S))
    assert told is not None and told[0].numbered and told[0].ahead == 1 and told[0].quantum_s == pytest.approx(1 / 30)
    fine = read_times(stamps(part_frames, 30, list(range(90)), START_S))
    assert fine is not None and not fine[0].numbered


@pytest.mark.parametrize("bad", [b"", b"--", b"1:2", b"nan:0:0:0", b"-1:00:00:00", b"1e9:00:00:00"])
def test_a_text_that_is_none_among_others_is_no_time_and_most_of_them_are_no_clock(bad: bytes) -> None:
    codes = stamps(frames, 30, list(range(60)), START_S)
    spoilt = [bad if row in (7, 8) else code for row, code in enumerate(codes)]
    found, whole = read_times(spoilt), read_times(codes)
    assert found is not None and whole is not None
    assert np.flatnonzero(np.isnan(found[1])).tolist() == [7, 8]
    np.testing.assert_array_equal(np.delete(found[1], [7, 8]), np.delete(whole[1], [7, 8]))
    assert read_times([bad if row % 2 else code for row, code in enumerate(codes)]) is None


def test_times_in_fewer_fields_are_minutes_and_hours() -> None:
    rows = range(2000)
    two = read_times([f"{row // 1800:02d}:{row / 30 % 60:06.3f}".encode() for row in rows])
    three = read_times([f"01:{row // 1800:02d}:{row / 30 % 60:06.3f}".encode() for row in rows])
    assert two is not None and three is not None
    np.testing.assert_allclose(two[1], np.array(rows) / 30, atol=1e-3)
    np.testing.assert_allclose(three[1], 3600 + np.array(rows) / 30, atol=1e-3)
    assert two[0].write(1812.25) == b"30:12.250" and three[0].write(7261.5) == b"02:01:01.500"
    assert three[0].write(DAY_S + 1.0) == b"00:00:01.000"


def test_the_middle_of_numbers_is_one_of_them() -> None:
    assert [middle(np.array(numbers)) for numbers in ([3.0], [4.0, 1.0], [9.0, 1.0, 5.0], [8.0, 2.0, 4.0, 6.0])] == [
        3.0,
        1.0,
        5.0,
        4.0,
    ]


@pytest.mark.parametrize("base", [60, 24, 25, 48, 50, 100, 240, 1000])
def test_a_style_goes_round_at_midnight(base: int) -> None:
    style = Style(base=base, digits=len(str(base - 1)), decimals=0)
    assert style.day_s == DAY_S
    last = Fraction(86_400 * base - 1, base)
    assert style.write(float(last)).decode().rsplit(":", 1)[0] == "23:59:59"
    assert int(style.write(float(last)).decode().rsplit(":", 1)[1]) == base - 1
    assert style.write(DAY_S) == style.write(0.0)
