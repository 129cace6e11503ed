"""What a file may ask for."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from engine.errors import FormatError
from engine.formats.base.budget import BUDGET, Budget

KINDS = ("bytes", "frames", "nodes", "values")


@pytest.mark.parametrize("kind", KINDS)
def test_what_fits_exactly_is_read_and_one_more_is_not(kind: str) -> None:
    limit = getattr(BUDGET, kind)
    BUDGET.require("head.glb", **{kind: limit})
    with pytest.raises(FormatError, match=r"head\.glb asks for .* at most") as caught:
        BUDGET.require("head.glb", **{kind: limit + 1})
    assert caught.value.advice


@pytest.mark.parametrize("number", [10**400, 10**5000, -1], ids=["long", "unprintable", "negative"])
@pytest.mark.parametrize("kind", KINDS)
def test_no_number_is_too_strange_for_a_short_sentence(kind: str, number: int) -> None:
    with pytest.raises(FormatError) as caught:
        BUDGET.require("x" * 5000, **{kind: number})
    assert len(str(caught.value)) < 300


@given(st.lists(st.integers(0, 40), max_size=8))
def test_parts_together_may_take_what_a_whole_may(parts: list[int]) -> None:
    left, spent = Budget(values=100), 0
    for part in parts:
        if spent + part > 100:
            with pytest.raises(FormatError):
                left.spend("a.csv", values=part)
            return
        left, spent = left.spend("a.csv", values=part), spent + part
    assert left.values == 100 - spent
