from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.errors import EditError
from engine.formats import read_take
from engine.lab.performer import demo
from engine.lab.performer.performer import Script, perform
from engine.models.resample import interpolate
from engine.review.align import align, on_clock_of
from engine.take import Take

DEMO = read_take(demo.BUNDLED)


def unstamped(take: Take, start: int = 0, stop: int | None = None, fps: float | None = None) -> Take:
    """A part of a take without a clock, at any rate."""
    rate = fps or take.fps
    part = take.weights[start:stop]
    at = np.arange(0, len(part) - 1, take.fps / rate)
    return Take(interpolate(part, at), rate, name=take.name)


def test_a_take_and_its_edit_are_on_one_clock() -> None:
    found = align(DEMO, DEMO.with_rows(50, DEMO.weights[50:80] * 0.5))
    assert found.offset_s == 0 and found.by == "start" and found.alike


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 150), st.sampled_from([24.0, 30.0, 60.0]))
def test_a_part_is_found_by_its_motion_at_any_rate(start: int, fps: float) -> None:
    found = align(unstamped(DEMO), unstamped(DEMO, start, start + 150, fps))
    assert found.offset_s == pytest.approx(start / DEMO.fps, abs=0.5 / 30) and found.alike


def test_another_performance_is_told_apart() -> None:
    other = perform(Script(phones=("SIL", "AA1", "T", "IY1", "SIL") * 6, seed=3), name="other")
    assert not align(unstamped(DEMO), unstamped(other)).alike


def test_swapping_the_takes_turns_the_offset_round() -> None:
    whole, part = unstamped(DEMO), unstamped(DEMO, 60, 210)
    assert align(part, whole).offset_s == pytest.approx(-align(whole, part).offset_s)


def test_timecodes_tell_where_a_later_take_lies() -> None:
    part = replace(unstamped(DEMO, 30, 200), start_s=DEMO.start_s + 1.0)
    found = align(replace(DEMO, start_s=DEMO.start_s or 5.0), replace(part, start_s=(DEMO.start_s or 5.0) + 1.0))
    assert found.by == "timecode" and found.offset_s == pytest.approx(1.0)


@pytest.mark.parametrize("offset_s", [1e6, -1e6, float("nan")])
def test_an_offset_without_a_common_frame_is_refused(offset_s: float) -> None:
    with pytest.raises(EditError, match="no frame in common"):
        align(DEMO, DEMO, offset_s=offset_s)


def test_whole_frames_are_the_recorded_values_to_the_bit() -> None:
    weights, common = on_clock_of(unstamped(DEMO, 40, 100), DEMO, 40 / DEMO.fps)
    np.testing.assert_array_equal(weights[common], DEMO.weights[40 : 40 + common.sum()])


def test_a_take_of_one_frame_is_aligned() -> None:
    one = Take(DEMO.weights[:1], DEMO.fps)
    assert np.isfinite(align(one, one).offset_s)


@pytest.mark.parametrize(("start_s", "by"), [(0.0, "start"), (36_000.0, "timecode")])
def test_a_take_with_one_face_left_and_its_fill_stay_on_their_clock(start_s: float, by: str) -> None:
    lost = np.arange(len(DEMO)) != 100
    still = np.repeat(DEMO.weights[100:101], len(DEMO), axis=0)
    before = Take(still, DEMO.fps, lost, start_s=start_s)
    after = replace(DEMO, lost=np.zeros(len(DEMO), bool), start_s=start_s)
    found = align(before, after)
    assert (found.offset_s, found.by) == (0.0, by)
