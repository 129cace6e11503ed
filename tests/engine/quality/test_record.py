from __future__ import annotations

import pytest

from engine.quality.record import LEAST, Flag, in_order, lasting, weight_of


@pytest.mark.parametrize(("amount", "weight"), [(3.0, 0.2), (4.0, 0.4), (5.0, 0.6), (7.0, 1.0), (700.0, 1.0)])
def test_a_flag_weighs_least_at_its_threshold_and_one_from_its_full_amount_on(amount: float, weight: float) -> None:
    assert LEAST == 0.2
    assert weight_of(amount, 3.0, 7.0) == pytest.approx(weight)
    assert weight_of(amount, 5.0, 5.0) == 1.0


def test_flags_come_by_their_first_frame_then_by_kind() -> None:
    flags = [Flag("b", 5, 9, 0.2, ""), Flag("a", 5, 7, 0.9, ""), Flag("z", 1, 99, 0.5, ""), Flag("a", 5, 6, 1.0, "")]
    assert [(flag.start, flag.kind, flag.stop) for flag in in_order(flags)] == [
        (1, "z", 99),
        (5, "a", 6),
        (5, "a", 7),
        (5, "b", 9),
    ]


def test_how_long_a_range_lasts_is_told_in_seconds_beyond_one_frame() -> None:
    assert [lasting(frames, 24.0) for frames in (1, 2, 36)] == ["1 frame", "2 frames (0.08 s)", "36 frames (1.50 s)"]
