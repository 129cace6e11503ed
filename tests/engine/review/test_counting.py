from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from engine.review.counting import counting_of, rate_of


@pytest.mark.parametrize(
    ("fps", "rate"),
    [
        (24.0, Fraction(24)),
        (23.976, Fraction(24000, 1001)),
        (23.98, Fraction(24000, 1001)),
        (29.97, Fraction(30000, 1001)),
        (30000 / 1001, Fraction(30000, 1001)),
        (59.94, Fraction(60000, 1001)),
        (30.0, Fraction(30)),
        (25.0, Fraction(25)),
        (12.5, Fraction(25, 2)),
    ],
)
def test_a_rate_is_what_editors_mean_by_it(fps: float, rate: Fraction) -> None:
    assert rate_of(fps) == rate


# The labels that SMPTE 12M gives around the borders of minutes.
@pytest.mark.parametrize(
    ("fps", "count", "label"),
    [
        (30.0, 1800, "00:01:00:00"),
        (24.0, 24 * 3661 + 5, "01:01:01:05"),
        (23.976, 24 * 60, "00:01:00:00"),
        (29.97, 0, "00:00:00;00"),
        (29.97, 1799, "00:00:59;29"),
        (29.97, 1800, "00:01:00;02"),
        (29.97, 3597, "00:01:59;29"),
        (29.97, 3598, "00:02:00;02"),
        (29.97, 17981, "00:09:59;29"),
        (29.97, 17982, "00:10:00;00"),
        (29.97, 107892, "01:00:00;00"),
        (59.94, 3600, "00:01:00;04"),
        (59.94, 215784, "01:00:00;00"),
        (120.0, 119, "00:00:00:119"),
    ],
)
def test_labels_are_those_of_the_standard(fps: float, count: int, label: str) -> None:
    assert counting_of(fps).label(count) == label


@pytest.mark.parametrize("fps", [29.97, 59.94])
@given(second=st.integers(0, 86_399))
def test_dropped_labels_keep_up_with_the_time_of_day(fps: float, second: int) -> None:
    counting = counting_of(fps)
    hours, minutes, rest = counting.label(counting.count_at(second)).split(":")
    seconds, frame = rest.split(";")
    shown = int(hours) * 3600 + int(minutes) * 60 + int(seconds) + int(frame) / counting.base
    assert abs(shown - second) < 0.2  # up to two labels in a minute, and 86 ms in a day, which the standard lets be


@pytest.mark.parametrize("fps", [23.976, 24.0, 25.0, 29.97, 59.94])
def test_an_hour_of_labels_goes_up_and_none_comes_twice(fps: float) -> None:
    counting = counting_of(fps)
    labels = [counting.label(count) for count in range(round(fps * 3600))]
    assert labels == sorted(set(labels))


@pytest.mark.parametrize(("fps", "frames"), [(25.0, 2_160_000), (29.97, 2_589_408), (59.94, 5_178_816)])
def test_labels_begin_anew_after_a_day(fps: float, frames: int) -> None:
    counting = counting_of(fps)
    assert counting.label(frames) == counting.label(0) < counting.label(frames - 1)
