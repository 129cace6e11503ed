from __future__ import annotations

import numpy as np
import pytest

from engine.extended import EXTENDED, EXTENDED_INDEX, bundled_extended
from engine.take import SHAPE_INDEX, SHAPES


def _moved(**weights: float) -> dict[str, float]:
    """Return by how much each extended control moves when shapes take these weights."""
    faces = np.zeros((2, len(SHAPES)))
    for name, weight in weights.items():
        faces[1, SHAPE_INDEX[name]] = weight
    rest, posed = bundled_extended().measure(faces)
    return {control.name: float(value) for control, value in zip(EXTENDED, posed - rest, strict=True)}


@pytest.mark.parametrize(
    ("shape", "control", "sign"),
    [
        ("browOuterUpRight", "brow_right", 1),
        ("browDownRight", "brow_right", -1),
        ("browOuterUpLeft", "brow_left", 1),
        ("browInnerUp", "brow_inner", 1),
        ("jawLeft", "jaw_sideways", 1),
        ("jawRight", "jaw_sideways", -1),
        ("eyeLookOutLeft", "gaze_horizontal", 1),
        ("eyeLookInRight", "gaze_horizontal", 1),
        ("eyeLookOutRight", "gaze_horizontal", -1),
        ("eyeLookUpLeft", "gaze_vertical", 1),
        ("eyeLookDownRight", "gaze_vertical", -1),
    ],
)
def test_each_shape_moves_its_control_its_way(shape: str, control: str, sign: int) -> None:
    assert sign * _moved(**{shape: 1.0})[control] > 1.0


def test_controls_do_not_mix() -> None:
    moved = _moved(eyeLookOutLeft=1.0, eyeLookInRight=1.0)
    assert moved["gaze_horizontal"] > 20  # degrees
    assert {name for name, value in moved.items() if abs(value) > 0.5} == {"gaze_horizontal"}
    assert _moved(eyeBlinkLeft=1.0, eyeBlinkRight=1.0)["gaze_vertical"] == pytest.approx(0.0, abs=0.1)


def test_their_columns_follow_the_eight() -> None:
    assert sorted(EXTENDED_INDEX.values()) == list(range(8, 14))
