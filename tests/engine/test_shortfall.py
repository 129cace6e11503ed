from __future__ import annotations

import numpy as np
import pytest

from engine.controls import ALL_CONTROLS, ALL_INDEX, bundled_measurer
from engine.exact import FREE, project
from engine.extended import bundled_face
from engine.shortfall import SHORT, shortfalls
from engine.take import SHAPES

LIPS, WIDTH = ALL_INDEX["lips_vertical"], ALL_INDEX["lips_horizontal"]


def test_what_no_face_reaches_is_told_with_the_limit_that_was_met() -> None:
    asked = np.full((1, len(ALL_CONTROLS)), np.nan)
    asked[0, LIPS] = 150.0
    made = project(
        np.zeros((1, len(SHAPES))), asked[:, [LIPS]], np.array([LIPS]), bundled_measurer(), free=FREE["lower"]
    )
    (short,) = shortfalls(made, asked, believability=0.0)
    assert (short.control, short.row, short.asked) == (LIPS, 0, 150.0)
    assert short.reached == pytest.approx(bundled_face().measure(made)[0, LIPS])
    assert "jawOpen" in short.why and "limit" in short.why and not short.believed
    assert str(short).startswith(f"lips apart {short.reached:.1f} mm of 150.0 asked: ")


def test_what_holds_a_control_back_is_told() -> None:
    """A face at rest with room to move: not a limit keeps it, but believability, or what else was asked."""
    rest = np.full((1, len(SHAPES)), 0.3)
    asked = np.full((1, len(ALL_CONTROLS)), np.nan)
    asked[0, LIPS] = bundled_face().measure(rest)[0, LIPS] + 4.0
    (short,) = shortfalls(rest, asked, believability=0.5)
    assert short.believed and "recordings" in short.why
    asked[0, WIDTH] = bundled_face().measure(rest)[0, WIDTH]
    (short,) = shortfalls(rest, asked, believability=0.0)
    assert not short.believed and "mouth width" in short.why


def test_nothing_is_told_of_what_is_met_or_never_asked() -> None:
    rng = np.random.default_rng(2)
    made = rng.random((10, len(SHAPES)))
    asked = bundled_face().measure(made) + rng.uniform(-SHORT, SHORT, (10, len(ALL_CONTROLS)))
    assert shortfalls(made, asked, believability=0.0) == []
    assert shortfalls(made, np.full((10, len(ALL_CONTROLS)), np.nan), believability=0.0) == []


def test_an_angle_is_told_in_degrees() -> None:
    asked = np.full((1, len(ALL_CONTROLS)), np.nan)
    asked[0, ALL_INDEX["gaze_horizontal"]] = 20.0
    assert "degrees" in str(shortfalls(np.zeros((1, len(SHAPES))), asked, believability=0.5)[0])
