"""Following a clock whose truth is known: which frame each row is, and which stamps are not believed."""

from __future__ import annotations

import numpy as np
import pytest

from engine.formats.livelink.walk import AHEAD, FEW_FRAMES, LONGEST_PAUSE_S, MAX_FRAMES, Walked, walk
from engine.take import Array

STEP_S, EXACT_S = 1 / 30, 1e-6  # of the clock, and of the fractions of a second that stamps are written in


def walked(frames: Array, quantum_s: float = EXACT_S, step_s: float = STEP_S) -> Walked:
    """Follow the stamps of rows which a recorder wrote at these frames of its clock."""
    return walk(np.asarray(frames, float) * step_s, step_s, quantum_s)


def nothing_odd(found: Walked) -> bool:
    return not (found.odd or found.set_back or found.pauses)


@pytest.mark.parametrize("missing", [0, 1, 2, FEW_FRAMES - 1, FEW_FRAMES, 40])
def test_rows_after_missing_frames_are_as_many_frames_later(missing: int) -> None:
    frames = np.arange(60)
    frames[25:] += missing
    found = walked(frames)
    np.testing.assert_array_equal(found.rows, frames)
    assert nothing_odd(found) and not found.uneven


def test_several_gaps_add_up_and_a_clock_that_begins_late_begins_at_its_first_row() -> None:
    frames = np.cumsum(np.random.default_rng(0).choice([1, 1, 1, 1, 1, 1, 1, 2, 3, 20], 300))
    found = walked(frames + 5000.0)
    np.testing.assert_array_equal(found.rows, frames - frames[0])
    assert nothing_odd(found)


def test_a_clock_that_runs_a_little_fast_or_jitters_loses_no_frame() -> None:
    noise = np.random.default_rng(1).uniform(-0.35, 0.35, 500)
    for frames in (np.arange(500) * 1.004, np.arange(500) * 0.996, np.arange(500) + noise):
        found = walked(frames)
        np.testing.assert_array_equal(found.rows, np.arange(500))
        assert nothing_odd(found)


@pytest.mark.parametrize("off", [0.8, -0.8, 5.0, -5.0, 400.0, -400.0, 1e7])
@pytest.mark.parametrize("row", [1, 20, 57])
def test_a_single_stamp_that_those_after_it_deny_is_odd_and_moves_no_row(off: float, row: int) -> None:
    frames = np.arange(60.0)
    frames[row] += off
    found = walked(frames)
    np.testing.assert_array_equal(found.rows, np.arange(60))
    assert found.odd == [row] and not found.set_back and not found.pauses


def test_half_a_frame_and_a_quarter_for_whole_frame_stamps_is_no_deviation() -> None:
    for quantum_s, within, beyond in ((EXACT_S, 0.49, 0.51), (STEP_S / 4, 0.62, 0.63), (STEP_S, 0.74, 0.76)):
        for off, odd in ((within, []), (beyond, [30])):
            frames = np.arange(60.0)
            frames[30] += off
            assert walked(frames, quantum_s).odd == odd, (quantum_s, off)


@pytest.mark.parametrize("few", [AHEAD // 2, AHEAD // 2 + 1])
def test_a_jump_counts_where_most_of_the_rows_ahead_agree(few: int) -> None:
    frames = np.arange(80.0)
    frames[40 : 40 + few] += 3
    found = walked(frames)
    if few == AHEAD // 2:
        assert found.odd == list(range(40, 44)) and found.rows[-1] == 79
    else:
        assert found.rows[40] == 43 and found.set_back == [45]
        np.testing.assert_array_equal(np.diff(found.rows[45:]), 1)


@pytest.mark.parametrize("back", [1, 3, 100])
def test_a_clock_that_is_set_back_goes_on_with_the_next_frame(back: int) -> None:
    frames = np.arange(60.0)
    frames[30:] -= back
    found = walked(frames)
    np.testing.assert_array_equal(found.rows, np.arange(60))
    assert found.set_back == [30] and not found.odd and not found.pauses and not found.uneven


def test_a_clock_that_goes_back_often_is_uneven_unless_it_paused() -> None:
    def set_back(times: int, *, pause: bool) -> Walked:
        frames = np.arange(500.0)
        for number in range(times):
            frames[(number + 1) * 60 :] -= 2
        if pause:
            frames[480:] += 2 * LONGEST_PAUSE_S / STEP_S
        return walked(frames)

    assert [set_back(times, pause=False).uneven for times in (3, 4)] == [False, True]
    assert not set_back(4, pause=True).uneven
    few = Walked(np.arange(2000), [], [1] * 10, [])
    assert not few.uneven and Walked(np.arange(1999), [], [1] * 10, []).uneven  # half a per cent of the rows


@pytest.mark.parametrize(("seconds", "left_out"), [(LONGEST_PAUSE_S - 1, False), (LONGEST_PAUSE_S + 1, True)])
def test_a_pause_that_is_no_part_of_a_performance_is_left_out(seconds: float, left_out: bool) -> None:
    frames = np.arange(60.0)
    frames[30:] += seconds / STEP_S
    found = walked(frames)
    np.testing.assert_array_equal(found.rows, np.arange(60) if left_out else np.round(frames))
    assert found.pauses == ([pytest.approx(seconds)] if left_out else [])


def test_pauses_are_left_out_before_a_take_becomes_longer_than_any() -> None:
    frames, pause = np.arange(700.0), 1700.0
    for at in range(20, 700, 20):
        frames[at:] += pause / STEP_S
    found = walked(frames)
    most = int((MAX_FRAMES - 700) // (pause / STEP_S))
    assert len(found.pauses) == 34 - most and found.rows[-1] + 1 <= MAX_FRAMES
    assert found.rows[-1] == 699 + most * round(pause / STEP_S)


@pytest.mark.parametrize(("rows", "seconds", "left_out"), [(2, 1.1, True), (2, 0.9, False), (3, 1.1, False)])
def test_a_jump_that_the_last_two_rows_alone_see_is_a_stamp(rows: int, seconds: float, left_out: bool) -> None:
    frames = np.arange(60.0)
    frames[-rows:] += seconds / STEP_S
    found = walked(frames)
    assert found.rows[-1] == (59 if left_out else 59 + round(seconds / STEP_S))
    assert len(found.pauses) == left_out


def test_a_first_stamp_that_all_others_deny_is_odd() -> None:
    for off in (-400.0, 400.0):
        frames = np.arange(60.0)
        frames[0] += off
        found = walked(frames)
        np.testing.assert_array_equal(found.rows, np.arange(60))
        assert found.odd == [0]
