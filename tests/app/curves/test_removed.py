from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from app.curves.removed import full_scale


@given(st.floats(0, 1e6), st.sampled_from([0.01, 0.1]))
def test_the_scale_is_round_and_no_more_than_two_and_a_half_times_too_large(largest: float, least: float) -> None:
    full = full_scale(largest, least)
    assert f"{full:.0e}"[0] in "125"
    assert max(largest, least) * (1 - 1e-6) <= full <= 2.5 * max(largest, least) * (1 + 1e-6)
