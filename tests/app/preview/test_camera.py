from __future__ import annotations

import numpy as np
import pytest

from app.preview.camera import FACE_WIDTH, FIELD_OF_VIEW_DEG, PRESETS, Camera, looking
from engine.character import bundled
from engine.framing import framed
from engine.take import Array

LOW, HIGH = np.array([-0.09, -0.16, -0.1]), np.array([0.09, 0.14, 0.11])


def across(camera: Camera, aspect: float, point: Array, low: Array = LOW, high: Array = HIGH) -> Array:
    """Return where a point falls in a picture, right and up, -1 to 1."""
    seen = np.linalg.inv(camera.pose(low, high, aspect=aspect)) @ np.append(point, 1.0)
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


EYES = ("lid_upper_left", "lid_lower_left", "lid_upper_right", "lid_lower_right")
MOUTH = ("mouth_left", "mouth_right", "lip_upper", "lip_lower")


@pytest.mark.parametrize("name, points", [("Eyes", EYES), ("Mouth", MOUTH)])
@pytest.mark.parametrize("aspect", [0.3, 0.6, 1.0, 2.0])
@pytest.mark.parametrize("longer, higher", [(1.0, 0.0), (1.4, 0.0), (1.0, 12.0), (1.0, -12.0)])
def test_a_close_view_meets_what_it_is_named_after(
    name: str, points: tuple[str, ...], aspect: float, longer: float, higher: float
) -> None:
    head = bundled()
    low, high = framed(head)
    stretch, shift = np.array([1.0, longer, 1.0]), np.array([0.0, higher, 0.0])  # heads are of all proportions
    at = {point: head.neutral[head.landmarks[point]].astype(float) * stretch + shift for point in head.landmarks}
    low, high = low * stretch, high * stretch
    camera = looking(name, at, low, high)
    seen = np.array([across(camera, aspect, at[point], low, high) for point in points])
    middle = (seen.min(axis=0) + seen.max(axis=0)) / 2
    assert np.abs(seen).max() < 0.95 and np.abs(middle).max() < 0.25
    assert np.ptp(seen, axis=0).max() > 0.35  # it is close


def test_a_head_without_landmarks_is_looked_at_as_the_bundled_one_is() -> None:
    head = bundled()
    low, high = framed(head)
    at = {point: head.neutral[vertex].astype(float) for point, vertex in head.landmarks.items()}
    for name in PRESETS:
        assert looking(name, {}, low, high) == PRESETS[name]
        there, here = looking(name, at, low, high), PRESETS[name]
        np.testing.assert_allclose(there.pan, here.pan, atol=0.03)
        if here.frame is not None and there.frame is not None:
            np.testing.assert_allclose(there.frame, here.frame, rtol=0.15)
