"""Lines on the picture lie on the same place of the head at every zoom, pan and size."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.preview.camera import PRESETS, Camera
from app.preview.marking import Marking, Plane, camera_of, numbers_of, seen_alike
from app.preview.picking import View
from engine.character import bundled
from engine.framing import framed
from engine.project import Drawing

SIZES = st.tuples(st.integers(200, 1200), st.integers(200, 1200))


@settings(max_examples=50, deadline=None)
@given(SIZES, st.floats(0.5, 8.0), st.floats(-1, 1), st.floats(-1, 1), st.floats(0, 1), st.floats(0, 1))
def test_a_pixel_and_its_place_belong_together(
    size: tuple[int, int], zoom: float, right: float, up: float, x: float, y: float
) -> None:
    plane = Plane(bundled(), Camera(10.0, 4.0, zoom, (right, up)), width=size[0], height=size[1])
    at = plane.point(x * size[0], y * size[1])
    np.testing.assert_allclose(plane.pixels([at])[0], (x * size[0], y * size[1]), atol=1e-6)


@pytest.mark.parametrize("size", [(400, 700), (900, 500)])
@pytest.mark.parametrize("camera", [Camera(), Camera(zoom=3.0, pan=(0.1, -0.2)), Camera(frame=(0.3, 0.3))])
def test_the_plane_is_where_the_camera_projects_the_middle_of_the_head(size: tuple[int, int], camera: Camera) -> None:
    low, high = framed(bundled())
    height = high[1] - low[1]
    pose = camera.pose(low, high, aspect=size[0] / size[1])
    right, up, ahead = pose[:3, 0], pose[:3, 1], pose[:3, 2]
    view = View(pose, 0.0, *size)
    plane = Plane(bundled(), camera, width=size[0], height=size[1])
    # the camera stands a quarter of the head's depth nearer than its field of view would have it
    nearer = ahead * (high - low)[2] / 4
    for place in ((0.0, 0.0), (0.2, -0.1)):
        point = (low + high) / 2 + nearer + height * (place[0] * right + place[1] * up)
        np.testing.assert_allclose(plane.pixels([place])[0], view.project(point[None])[0], atol=1e-6)


@pytest.mark.parametrize("camera", list(PRESETS.values()))
def test_a_camera_comes_back_from_a_drawing(camera: Camera) -> None:
    drawing = Drawing((((0.0, 0.0),),), numbers_of(camera))
    assert camera_of(drawing) == camera and seen_alike(drawing, camera.zoomed(2.0).panned(0.1, 0.1))
    assert not seen_alike(drawing, camera.orbited(around_deg=5.0, above_deg=0.0))


def test_cameras_that_cannot_be_are_none() -> None:
    for numbers in ((), (0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 1.0)):
        assert camera_of(Drawing((), numbers)) is None


def test_what_is_drawn_is_taken_once_and_a_press_is_a_dot() -> None:
    marking = Marking()
    marking.begin((0.1, 0.1))
    marking.go_on((0.1, 0.1))
    marking.go_on((0.2, 0.1))
    marking.end()
    marking.go_on((0.9, 0.9))
    marking.begin((0.3, 0.3))
    drawing = marking.taken(Camera())
    assert drawing is not None and drawing.strokes == (((0.1, 0.1), (0.2, 0.1)), ((0.3, 0.3),))
    assert marking.taken(Camera()) is None
