from __future__ import annotations

import pytest

from engine.errors import EditError
from engine.formats.base.reading import AUTOMATIC, SIDES, SIDES_IN_WORDS, Reading


@pytest.mark.parametrize(
    ("asked", "taken"),
    [
        (23.976, 24000 / 1001),
        (29.97, 30000 / 1001),
        (59.94, 60000 / 1001),
        (119.88, 120000 / 1001),
        (29.96, 29.96),
        (30.0, 30.0),
        (1.0, 1.0),
        (1000.0, 1000.0),
        (29.9651, 30000 / 1001),
        (29.9649, 29.9649),
    ],
)
def test_rates_of_television_are_meant_exactly_and_others_as_they_are(asked: float, taken: float) -> None:
    assert Reading(asked).fps == taken


@pytest.mark.parametrize("fps", [0.999, 1000.1, 0.0, -30.0, float("nan"), float("inf")])
def test_a_rate_that_no_take_has_is_refused(fps: float) -> None:
    with pytest.raises(EditError, match="not a rate of a take"):
        Reading(fps)


def test_sides_are_one_of_three_and_all_have_words() -> None:
    assert Reading(None, "automatic") == AUTOMATIC and set(SIDES_IN_WORDS) == set(SIDES)
    assert [Reading(sides=sides).sides for sides in SIDES] == ["automatic", "recorded", "named"]
    with pytest.raises(EditError, match="'left' is not a choice of sides") as refused:
        Reading(sides="left")  # type: ignore[arg-type]
    assert "automatic, recorded, named" in refused.value.advice
