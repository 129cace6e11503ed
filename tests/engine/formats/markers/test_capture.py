from __future__ import annotations

import numpy as np
import pytest

from engine.errors import EditError
from engine.formats.markers.capture import TO_MM, Markers, each_once, unit_by_size, unit_named

PLACES = np.random.default_rng(0).normal(0, 50, (4, 2, 3))


def test_a_capture_may_have_gaps_and_any_rate_that_can_be() -> None:
    gappy = PLACES.copy()
    gappy[1, 0] = np.nan
    for fps in (0.01, 10_000.0):
        assert len(Markers(gappy, ("a", "b"), fps)) == 4


@pytest.mark.parametrize(
    ("positions", "names", "fps", "says"),
    [
        (PLACES[:0], ("a", "b"), 30.0, "at least one frame"),
        (PLACES[..., :2], ("a", "b"), 30.0, "three coordinates"),
        (PLACES, ("a",), 30.0, "three coordinates"),
        (PLACES[0], ("a", "b"), 30.0, "three coordinates"),
        (PLACES, ("a", "a"), 30.0, "'a' is there twice"),
        (np.where(PLACES[2, 1, 1] == PLACES, 1.1e8, PLACES), ("a", "b"), 30.0, "further away"),
        (np.where(PLACES[2, 1, 1] == PLACES, -1.1e8, PLACES), ("a", "b"), 30.0, "further away"),
        (PLACES, ("a", "b"), 0.009, "frame rate"),
        (PLACES, ("a", "b"), 10_001.0, "frame rate"),
        (PLACES, ("a", "b"), float("nan"), "frame rate"),
    ],
)
def test_what_is_no_capture_is_a_sentence(positions: np.ndarray, names: tuple[str, ...], fps: float, says: str) -> None:
    with pytest.raises(EditError, match=says):
        Markers(positions, names, fps)


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("mm", "mm"), (" CM ", "cm"), ("m", "m"), ("in", "in"), ("Millimetres", "mm"), ("centimeters", "cm"),
        ("meter", "m"), ("metre", "m"), ("Inches", "in"), ("furlong", None), ("", None), ("kilometer", None),
    ],
)  # fmt: skip
def test_units_are_known_short_and_in_full(text: str, unit: str | None) -> None:
    assert unit_named(text) == unit and (unit is None or unit in TO_MM)


def test_a_unit_is_ten_hundred_or_a_thousand_millimetres() -> None:
    assert TO_MM == {"mm": 1, "cm": 10, "m": 1000, "in": 25.4}


@pytest.mark.parametrize(
    ("given", "taken", "doubled"),
    [
        (["a", "b"], ("a", "b"), 0),
        (["a", "a", " a "], ("a", "a 2", "a 3"), 2),
        (["a", "a 2", "a"], ("a", "a 2", "a 3"), 1),
        (["a", "a", "a 2"], ("a", "a 3", "a 2"), 1),
        (["", "x", ""], ("marker 1", "x", "marker 3"), 0),
        (["marker 2", ""], ("marker 2", "marker 2 2"), 1),
    ],
)
def test_names_that_are_there_already_get_a_number_and_that_is_said(given, taken, doubled: int) -> None:
    names, said = each_once(given)
    assert names == taken and len(said) == bool(doubled)
    assert not said or said[0].startswith(
        f"{doubled} marker{'s' * (doubled > 1)} {'have' if doubled > 1 else 'has'} a name"
    )


@pytest.mark.parametrize(
    ("extent", "unit"), [(0.2, "m"), (1.49, "m"), (1.51, "cm"), (20.0, "cm"), (44.0, "cm"), (46.0, "mm"), (200.0, "mm")]
)
def test_the_unit_is_the_one_in_which_a_face_has_that_size(extent: float, unit: str) -> None:
    rng = np.random.default_rng(1)
    places = rng.random((5, 30, 3)) * extent / 2
    places[:, 0], places[:, 1] = 0.0, [extent, 0, 0]
    places[2, 5] = np.nan
    places[3] *= 100  # one frame of five
    found, said = unit_by_size(places + 700.0)
    assert found == unit and said == f"Positions are taken as {unit}: the markers span {extent:.3g} {unit}."
