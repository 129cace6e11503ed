from __future__ import annotations

import numpy as np

from engine.character import bundled
from engine.controls import CONTROLS, bundled_measurer, measure
from engine.take import SHAPE_INDEX, SHAPES, Take


def test_controls_equal_distances_on_the_posed_mesh(random_take: Take) -> None:
    character = bundled()
    for weights, measured in zip(random_take.weights[:5], measure(random_take.weights[:5]), strict=True):
        vertices = character.vertices(weights)
        for control, value in zip(CONTROLS, measured, strict=True):
            start, end = (vertices[character.landmarks[name]] for name in (control.start, control.end))
            np.testing.assert_allclose(value, np.linalg.norm(end - start), atol=1e-3)


def test_jacobian_equals_finite_differences(random_take: Take) -> None:
    weights, step = random_take.weights[:8], 1e-6
    slope = bundled_measurer().jacobian(weights)
    for shape in range(len(SHAPES)):
        moved = weights.copy()
        moved[:, shape] += step
        np.testing.assert_allclose((measure(moved) - measure(weights)) / step, slope[:, :, shape], atol=1e-3)


def test_blink_closes_the_eye_and_jaw_parts_the_lips() -> None:
    weights = np.zeros((3, len(SHAPES)))
    weights[1, SHAPE_INDEX["jawOpen"]] = 1
    weights[2, SHAPE_INDEX["eyeBlinkLeft"]] = 1
    lips, eye = measure(weights)[:, 0], measure(weights)[:, 3]
    assert lips[0] < 0.5 and 35 < lips[1] < 50 and eye[0] > 8 and eye[2] < 0.5
