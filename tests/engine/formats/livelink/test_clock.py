"""Every style of clock at every rate, with every fault that writers of timecodes are known for."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest

from engine.formats.livelink.clock import Clock, clock_of, timecodes_between
from engine.formats.livelink.timecode import read_times
from tests.engine.formats.livelink.stamps import (
    CASES,
    EXACT,
    Stamps,
    clocked,
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
    whole_sixtieths,
)

STARTS_S = [0, 3 * 3600 + 59 * 60 + 55.5]


def off_by(clock: Clock, rate: float, rows: list[int]) -> float:
    """Return by how many frames the row that is furthest off stands elsewhere than it was recorded."""
    found = clock.rows / clock.fps * rate
    return float(np.abs(found - found[0] - (np.array(rows) - rows[0])).max())


@pytest.mark.parametrize("start_s", STARTS_S)
@pytest.mark.parametrize(("style", "rate"), CASES, ids=named)
def test_every_frame_is_where_it_was_recorded(style: Stamps, rate: float, start_s: float) -> None:
    if start_s == 0 and (style, rate) in ((part_frames, 29.97), (whole_sixtieths, 29.97)):
        pytest.skip("from midnight on these are a writer's numbered frames, and sixtieths of 30 fps")
    rows = list(range(round(65 * rate) if "drop" in named(style) else length(style, rate)))
    clock = clock_of(stamps(style, rate, rows, start_s))
    assert clock.fps == pytest.approx(float(exact(rate)), rel=1e-6)
    assert off_by(clock, float(exact(rate)), rows) < 0.5
    assert (clock.missed, clock.odd) == (0, 0)


FAULTS: dict[str, Callable[[list[int]], list[int]]] = {
    "single rows absent": lambda rows: [row for row in rows if row % 37 != 5],
    "half a second absent": lambda rows: [row for row in rows if not len(rows) // 3 <= row < len(rows) // 3 + 20],
    "a long pause": lambda rows: [*rows[: len(rows) // 2], *(row + 3000 for row in rows[len(rows) // 2 :])],
    "second row absent": lambda rows: [row for row in rows if row != 1],
    "last but one absent": lambda rows: [row for row in rows if row != len(rows) - 2],
}
# What is absent or odd in stamps that are coarser than the frames shows late, by a frame or two.
FINE = [case for case in CASES if case[0] is not whole_sixtieths or case[1] in (24, 25, 30, 60)]


@pytest.mark.parametrize(("style", "rate"), FINE, ids=named)
def test_absent_rows_are_gaps(style: Stamps, rate: float) -> None:
    for fault, without in FAULTS.items():
        if style is drop_frames_unsaid and fault == "a long pause":
            continue  # without a minute's end nothing tells that labels are dropped
        rows = without(list(range(length(style, rate))))
        clock = clock_of(stamps(style, rate, rows))
        assert clock.fps == pytest.approx(float(exact(rate)), rel=1e-6), fault
        assert off_by(clock, float(exact(rate)), rows) < 0.5, fault
        assert clock.odd == 0, fault


ODD: dict[str, Callable[[list[bytes]], list[bytes]]] = {
    "one duplicate": lambda codes: [*codes[:100], codes[99], *codes[101:]],
    "three duplicates": lambda codes: [
        codes[row - 1] if row in (40, 41, 150) else code for row, code in enumerate(codes)
    ],
    "one of the start": lambda codes: [*codes[:100], codes[0], *codes[101:]],
    "one of the end": lambda codes: [*codes[:100], codes[-1], *codes[101:]],
    "one in words": lambda codes: [*codes[:100], b"--:--", *codes[101:]],
    "one empty": lambda codes: [*codes[:100], b"", *codes[101:]],
    "the first": lambda codes: [codes[150], *codes[1:]],
    "two swapped": lambda codes: [*codes[:100], codes[101], codes[100], *codes[102:]],
}


@pytest.mark.parametrize(("style", "rate"), FINE, ids=named)
def test_an_odd_stamp_is_no_reason_to_doubt_the_others(style: Stamps, rate: float) -> None:
    rows = list(range(length(style, rate)))
    for fault, spoilt in ODD.items():
        clock = clock_of(spoilt(stamps(style, rate, rows)))
        assert clock.fps == pytest.approx(float(exact(rate)), rel=1e-6), fault
        assert off_by(clock, float(exact(rate)), rows) < 0.5, fault
        assert clock.missed == 0, fault
        if style is not whole_sixtieths:
            assert any("out of order" in notice for notice in clock.notices), fault


@pytest.mark.parametrize("back_s", [0.02, 0.1, 5.0])
@pytest.mark.parametrize(("style", "rate"), [case for case in FINE if case[0] is not drop_frames_unsaid], ids=named)
def test_a_clock_that_was_set_back_goes_on(style: Stamps, rate: float, back_s: float) -> None:
    rows = list(range(length(style, rate)))
    back = max(2, round(back_s * rate))
    codes = stamps(style, rate, [row if row < 200 else row - back for row in rows])
    clock = clock_of(codes)
    assert clock.fps == pytest.approx(float(exact(rate)), rel=1e-6)
    assert (off_by(clock, float(exact(rate)), rows), clock.missed) == (pytest.approx(0, abs=0.5), 0)
    assert any("set back once" in notice for notice in clock.notices)


@pytest.mark.parametrize("speed", [0.9985, 0.9995, 1.0004, 1.0015])
@pytest.mark.parametrize("rate", [24, 25, 30, 48, 50, 60, 120])
def test_a_clock_of_slightly_wrong_speed_is_that_of_a_usual_rate(rate: int, speed: float) -> None:
    codes = [sixtieths(row, Fraction(rate) / Fraction(speed)).encode() for row in range(20 * rate)]
    clock = clock_of(codes)
    near = {rate, rate / 1.001} if rate in (24, 30, 60, 120) else {rate}
    assert any(clock.fps == pytest.approx(each, rel=1e-9) for each in near)
    assert (clock.missed, clock.odd) == (0, 0)


@pytest.mark.parametrize(("style", "rate"), FINE, ids=named)
def test_midnight_is_a_moment_like_any_other(style: Stamps, rate: float) -> None:
    if style in (seconds, plain_thousandths):
        pytest.skip("plain numbers go on past midnight")
    if style is numbered and rate == 24:
        pytest.skip("a number that is not begun anew at midnight and a label that is")
    first = round(86_400 * exact(rate)) - round(5 * rate)
    before = round(5 * rate)
    if style in (drop_frames, drop_frames_unsaid):
        per_day = 144 * (600 * round(rate) - 9 * (round(rate) // 15))
        first = per_day - before
        codes = [style((first + row) % per_day, exact(rate)) for row in range(2 * before)]
    else:
        codes = [style(first + row, exact(rate)) for row in range(2 * before)]
    clock = clock_of([code.encode() for code in codes])
    if style is not drop_frames_unsaid:  # whose labels show in ten seconds without a minute's end
        assert clock.fps == pytest.approx(float(exact(rate)), rel=1e-6)
    assert (clock.missed, clock.odd) == (0, 0)
    assert clock.start_s == pytest.approx(86_400 - before / rate, abs=0.2)


HALF = Fraction(30)
OTHERS: dict[str, tuple[list[str], float]] = {
    "every stamp twice": ([sixtieths(2 * (row // 2), Fraction(60)) for row in range(600)], 60),
    "every frame's number twice": ([frames(row // 2, HALF) for row in range(600)], 60),
    "frames counted from one": ([f"{clocked(row // 30)}:{row % 30 + 1:02d}" for row in range(300)], 30),
    "a second and a row": ([frames(row, HALF) for row in range(31)], 30),
    "a webcam's fifteen": ([frames(row, Fraction(15)) for row in range(100)], 15),
    "a webcam's own rate": ([frames(row, Fraction(28)) for row in range(200)], 28),
    "24 fps in thirtieths": ([f"{clocked(Fraction(r, 24))}:{int(r % 24 * 30 / 24):02d}" for r in range(300)], 24),
    "25 fps in thirtieths": ([f"{clocked(Fraction(r, 25))}:{int(r % 25 * 30 / 25):02d}" for r in range(300)], 25),
    "thousandths behind the frame": ([f"{frames(r, HALF)}.{int(r % 30 / 0.03):03d}" for r in range(300)], 30),
    "numbered rows at a time of day": ([f"{frames(r + 40_007, HALF)}.{r:03d}" for r in range(300)], 30),
    "numbered rows, begun anew": ([f"{sixtieths(r, Fraction(60))[:-4]}.{r % 1000:03d}" for r in range(1500)], 60),
    "since 1970": ([f"{1.7e9 + row / 30:.3f}" for row in range(200)], 30),
    "since 1970, in thousandths": ([f"{1.7e12 + row * 1000 / 30:.0f}" for row in range(200)], 30),
    "since 1970, in billionths": ([f"{1.7e18 + row * 1e9 / 30:.0f}" for row in range(200)], 30),
    "microseconds": ([f"{clocked(Fraction(r, 30))}:{r % 30 * 33_333:06d}" for r in range(200)], 30),
    "minutes and seconds": ([f"{row // 1800:02d}:{row / 30 % 60:06.3f}" for row in range(2000)], 30),
    "hundredths": ([f"{clocked(Fraction(row, 25))}:{row % 25 * 4:02d}" for row in range(300)], 25),
    "59.94 from a whole hour": (
        [sixtieths(row + 3600 * exact(59.94), exact(59.94)) for row in range(300)],
        60_000 / 1001,
    ),
    "59.94 from a whole frame": (
        [sixtieths(row + 36_007 * exact(59.94), exact(59.94)) for row in range(300)],
        60_000 / 1001,
    ),
    "the app's 59.94": ([sixtieths(row + 7777, exact(59.94)) for row in range(300)], 60_000 / 1001),
}


@pytest.mark.parametrize("kind", OTHERS)
def test_writers_of_other_kinds_are_understood(kind: str) -> None:
    codes, rate = OTHERS[kind]
    clock = clock_of([code.encode() for code in codes])
    assert clock.fps == pytest.approx(rate, rel=1e-9)
    assert clock.rows.tolist() == list(range(len(codes)))


@pytest.mark.parametrize("rate", [24, 30, 60])
@pytest.mark.parametrize("spread_s", [0.002, 0.004, 0.008])
def test_an_uneven_clock_tells_the_rate_all_the_same(rate: int, spread_s: float) -> None:
    rng = np.random.default_rng(4)
    times = np.maximum.accumulate(36_000 + np.arange(1200) / rate + rng.normal(0, spread_s, 1200))
    clock = clock_of([f"{clocked(Fraction(time))}:{int(time % 1 * 1000):03d}".encode() for time in times])
    assert clock.fps == pytest.approx(rate, rel=1.1e-3)
    assert clock.rows[-1] / clock.fps == pytest.approx(1199 / rate, rel=0.012)


@pytest.mark.parametrize("rate", EXACT)
def test_labels_that_are_never_dropped_need_the_rate(rate: float) -> None:
    rows = list(range(600))
    codes = stamps(frames, rate, rows)
    assert clock_of(codes).fps == round(rate)
    clock = clock_of(codes, float(exact(rate)))
    assert off_by(clock, float(exact(rate)), rows) < 1e-6 and "as asked" in clock.notices[0]


@pytest.mark.parametrize(
    ("codes", "fps", "says"),
    [
        ([f"00:00:{row:02d}:00" for row in range(20)], 30.0, "make no sense"),
        (["nonsense"] * 5, 30.0, "make no sense"),
        (["00:00:00:00.000"] * 50, 30.0, "make no sense"),
        ([str(row) for row in range(20)], 30.0, "numbered"),
        ([""] * 20, 30.0, "make no sense"),
        (["inf"] * 20, 30.0, "make no sense"),
        (["1e300"] * 20, 30.0, "make no sense"),
    ],
)
def test_what_is_no_clock_is_said_and_asked_for(codes: list[str], fps: float, says: str) -> None:
    clock = clock_of([code.encode() for code in codes])
    assert clock.fps == fps and says in clock.notices[0] and "--fps" in clock.notices[0]
    assert clock.rows.tolist() == list(range(len(codes)))


def test_times_in_any_order_are_taken_row_by_row() -> None:
    rng = np.random.default_rng(0)
    codes = [sixtieths(int(frame), Fraction(30)).encode() for frame in rng.permutation(300)]
    clock = clock_of(codes)
    assert clock.rows.tolist() == list(range(300)) and clock.notices


def test_a_pause_of_hours_is_left_out_and_said() -> None:
    rows = [*range(300), *(row + 10 * 3600 * 60 for row in range(300, 600))]
    clock = clock_of(stamps(sixtieths, 60, rows, 0))
    assert clock.rows[-1] == 599 and "leap" in " ".join(clock.notices)


@pytest.mark.parametrize(("style", "rate"), FINE, ids=named)
def test_timecodes_for_absent_rows_are_what_the_file_would_have_said(style: Stamps, rate: float) -> None:
    whole = list(range(length(style, rate)))
    absent = [row for row in whole if 70 <= row < 90 or row == 33]
    rows = [row for row in whole if row not in absent]
    start_s = 35_995.5 if style is not numbered else 0.0
    codes = stamps(style, rate, rows, start_s)
    clock = clock_of(codes)
    made = timecodes_between(codes, clock.rows, absent, fps=clock.fps)
    assert [len(code) for code in made] == [len(code) for code in stamps(style, rate, absent, start_s)]
    whole_codes: list[bytes] = [b""] * len(whole)
    for row, code in zip([*rows, *absent], [*codes, *made], strict=True):
        whole_codes[row] = code
    again = clock_of(whole_codes)
    assert (again.fps, again.missed) == (pytest.approx(clock.fps), 0)
    right = read_times(stamps(style, rate, whole, start_s))
    put = read_times(whole_codes)
    assert right is not None and put is not None
    assert np.abs(right[1] - put[1]).max() < (1 / 60 if style is whole_sixtieths else 2e-3) + 1e-9


PIECES = ["0", "59", "1e300", "-1", "nan", "inf", "1e15", "9" * 20, "", "x", "30.999", "86400", "1e-300", "-1e300"]


@pytest.mark.parametrize("seed", range(60))
def test_whatever_stands_there_rows_keep_their_order(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(10):
        count, fields = int(rng.choice([1, 2, 3, 5, 40])), int(rng.integers(1, 6))
        codes = [f"00:00:{row // 30:02d}:{row % 30:02d}" for row in range(count)]
        for row in range(count if rng.random() < 0.5 else 3):
            codes[row % count] = str(rng.choice([":", ";"])).join(rng.choice(PIECES, fields))
        texts = [code.encode() for code in codes]
        clock = clock_of(texts)
        assert 0 < clock.fps < 1001 and 0 <= clock.start_s <= 86_400, codes
        assert clock.rows[0] == 0 and (np.diff(clock.rows) >= 1).all() and len(clock.rows) == count
        assert len(timecodes_between(texts, clock.rows, [0, int(clock.rows[-1])], fps=clock.fps)) == 2


@pytest.mark.parametrize(
    ("gaps", "said"), [([150], "a gap of 150 s"), ([1], "a gap of 1.00 s"), ([2, 2], "2 gaps, 4.00 s in all")]
)
def test_gaps_are_said_with_their_length_in_plain_numbers(gaps: list[int], said: str) -> None:
    times = np.arange(120) / 30
    for place, gap_s in enumerate(gaps):
        times[40 * (place + 1) :] += gap_s
    notices = clock_of([f"{time:.4f}".encode() for time in times]).notices
    assert any(said in notice for notice in notices), notices
