from __future__ import annotations

import numpy as np
import pytest

from engine.controls import ALL_CONTROLS, bundled_measurer
from engine.extended import EXTENDED_INDEX, bundled_face
from engine.lab.performer.augment import MIRROR
from engine.regress.prior import MIRROR_CONTROL, MIRROR_SIGN
from engine.take import SHAPE_INDEX, SHAPES, Array


def _moved(**weights: float) -> dict[str, float]:
    """Return by how much each control moves when shapes take these weights."""
    faces = np.zeros((2, len(SHAPES)))
    for name, weight in weights.items():
        faces[1, SHAPE_INDEX[name]] = weight
    rest, posed = bundled_face().measure(faces)
    return {control.name: float(value) for control, value in zip(ALL_CONTROLS, posed - rest, strict=True)}


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
        ("mouthSmileLeft", "corner_height_left", 1),
        ("mouthFrownRight", "corner_height_right", -1),
    ],
)
def test_each_shape_moves_its_control_its_way(shape: str, control: str, sign: int) -> None:
    assert sign * _moved(**{shape: 1.0})[control] > 1.0


def test_controls_do_not_mix() -> None:
    moved = _moved(eyeLookOutLeft=1.0, eyeLookInRight=1.0)
    assert moved["gaze_horizontal"] > 20  # degrees
    assert {name for name in EXTENDED_INDEX if abs(moved[name]) > 0.5} == {"gaze_horizontal"}
    assert _moved(eyeBlinkLeft=1.0, eyeBlinkRight=1.0)["gaze_vertical"] == pytest.approx(0.0, abs=0.1)


def test_their_columns_follow_the_eight() -> None:
    assert sorted(EXTENDED_INDEX.values()) == list(range(8, 16))


def faces(count: int) -> Array:
    return np.random.default_rng(5).random((count, len(SHAPES)))


def test_the_eight_are_as_they_are_measured_alone() -> None:
    np.testing.assert_array_equal(bundled_face().measure(faces(20))[:, :8], bundled_measurer().measure(faces(20)))


def test_the_jacobian_is_the_derivative() -> None:
    weights, step = faces(20), 1e-6
    columns = np.arange(len(ALL_CONTROLS))
    value, slope = bundled_face().jacobian(weights, columns)
    np.testing.assert_array_equal(value, bundled_face().measure(weights))
    for shape in range(len(SHAPES)):
        aside = np.zeros(len(SHAPES))
        aside[shape] = step
        numeric = (bundled_face().measure(weights + aside) - bundled_face().measure(weights - aside)) / (2 * step)
        np.testing.assert_allclose(slope[:, :, shape], numeric, rtol=0, atol=1e-5)


def test_a_mirrored_face_measures_mirrored() -> None:
    measured, other = (bundled_face().measure(each) for each in (faces(20), faces(20)[:, MIRROR]))
    np.testing.assert_allclose(other, MIRROR_SIGN * measured[:, MIRROR_CONTROL], rtol=0, atol=1e-9)
