from __future__ import annotations

import numpy as np
import pytest

from app.preview.camera import PRESETS, Camera
from app.preview.overlay import Overlay
from app.preview.picking import View, vertex_under, views
from app.session.sides import Dot, Side
from engine.character import bundled
from engine.take import SHAPES, Array

REST = np.zeros(len(SHAPES))


def view(camera: Camera | None = None) -> View:
    return views((Side("", REST),), camera or Camera(), 400, 500)[0]


@pytest.mark.parametrize("name", list(PRESETS))
def test_the_ray_through_a_point_s_pixel_meets_the_point(name: str) -> None:
    seen = view(PRESETS[name])
    points = bundled().neutral[::97].astype(float)
    for point, (x, y) in zip(points, seen.project(points), strict=True):
        away = point - seen.eye
        np.testing.assert_allclose(seen.ray(x, y), away / np.linalg.norm(away), atol=1e-9)


def plainly_under(seen: View, x: float, y: float) -> int | None:
    """The same triangle by triangle, by solving for the place where ray and plane meet."""
    corners, ray = bundled().neutral[bundled().triangles].astype(float), seen.ray(x, y)
    best: tuple[float, int] | None = None
    for index, (a, b, c) in enumerate(corners):
        try:
            depth, u, v = np.linalg.solve(np.stack([-ray, b - a, c - a], axis=1), seen.eye - a)
        except np.linalg.LinAlgError:
            continue
        if depth > 0 and min(u, v) >= 0 and u + v <= 1 and (best is None or depth < best[0]):
            best = (depth, index)
    if best is None:
        return None
    vertices = bundled().triangles[best[1]]
    flat = seen.project(bundled().neutral[vertices].astype(float))
    return int(vertices[np.argmin(np.hypot(*(flat - (x, y)).T))])


@pytest.mark.parametrize(("x", "y"), [(200.3, 250.2), (150.1, 320.7), (240.6, 180.4), (5.0, 5.0)])
def test_the_vertex_under_a_pixel_is_the_nearest_corner_of_the_first_triangle(x: float, y: float) -> None:
    seen = view()
    assert vertex_under(bundled(), REST, seen, x, y) == plainly_under(seen, x, y)


def test_what_is_hidden_is_never_picked() -> None:
    seen = view(PRESETS["Side"])
    found = [vertex_under(bundled(), REST, seen, x, 260.0) for x in np.linspace(150, 250, 15)]
    sides: Array = bundled().neutral[[vertex for vertex in found if vertex is not None], 0]
    assert len(sides) == 15 and (sides >= -3.0).all()


def test_dots_are_drawn_where_their_vertices_are_and_not_through_the_head() -> None:
    nose, crown_back = bundled().landmarks["nose_tip"], int(np.argmin(bundled().neutral[:, 2]))
    side = Side("", REST, dots=(Dot("nose", nose), Dot("back", crown_back)))
    overlay = Overlay.of((side, side), Camera(), 800, 500)
    assert overlay.seen[0].tolist() == [True, False]
    x, y = overlay.at[1][0]
    assert overlay.dot_at(x + 2, y) == (1, 0) and overlay.dot_at(x + 40, y) is None
    assert vertex_under(bundled(), REST, overlay.views[1], x, y) == nose


def test_markers_that_are_not_seen_have_no_dot() -> None:
    box = (np.full(3, -50.0), np.full(3, 50.0))
    dots = (Dot("seen", place=np.zeros(3)), Dot("gone"))
    overlay = Overlay.of((Side("", None, dots=dots, box=box),), Camera(above_deg=0.0), 300, 300)
    assert overlay.seen[0].tolist() == [True, False]
    np.testing.assert_allclose(overlay.at[0][0], [150, 150])
