from __future__ import annotations

import numpy as np
import pytest

from app.preview.camera import FACE_WIDTH, FIELD_OF_VIEW_DEG, PRESETS, Camera
from engine.take import Array

LOW, HIGH = np.array([-0.09, -0.16, -0.1]), np.array([0.09, 0.14, 0.11])


def across(camera: Camera, aspect: float, point: Array) -> Array:
    """Return where a point falls in a picture, right and up, -1 to 1."""
    seen = np.linalg.inv(camera.pose(LOW, HIGH, aspect=aspect)) @ np.append(point, 1.0)
    return seen[:2] / -seen[2] / np.tan(np.radians(FIELD_OF_VIEW_DEG / 2)) / (aspect, 1.0)


@pytest.mark.parametrize("aspect", [0.3, 0.45, 0.6, 1.0, 2.0])
def test_the_face_is_always_in_the_picture_and_fills_it(aspect: float) -> None:
    middle = (LOW + HIGH) / 2
    corners = [across(PRESETS["Front"], aspect, middle + half * (HIGH - LOW) / 2) for half in _sides()]
    assert np.abs(corners).max() < 1.0  # the ears may go, the face and all of its height may not
    assert np.abs(corners).max() > 0.85  # and no room is left on both axes


def _sides() -> list[Array]:
    return [np.array([x, y, 0.0]) for x in (-FACE_WIDTH, FACE_WIDTH) for y in (-0.95, 0.95)]


@pytest.mark.parametrize("aspect", [0.3, 0.6, 1.0])
def test_from_the_side_nothing_is_cut(aspect: float) -> None:
    middle = (LOW + HIGH) / 2
    for depth in (LOW[2], HIGH[2]):
        assert np.abs(across(PRESETS["Side"], aspect, np.array([0.0, middle[1], depth]))).max() < 1.0
