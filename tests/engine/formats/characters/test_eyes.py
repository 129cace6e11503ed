from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from engine.character import bundled
from engine.formats.characters.eyes import eyeballs, fit_ball

RNG = np.random.default_rng(0)


def ball(
    centre: tuple[float, ...], radius: float, count: int = 60, stretch: float = 1.0
) -> tuple[np.ndarray, np.ndarray]:
    points = RNG.normal(size=(count, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return radius * points * [stretch, 1, 1] + centre, ConvexHull(points).simplices


def mesh(*parts: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    starts = np.cumsum([0, *(len(points) for points, _ in parts)])
    corners = [triangles + start for (_, triangles), start in zip(parts, starts, strict=False)]
    return np.concatenate([points for points, _ in parts]), np.concatenate(corners).astype(np.int32)


def test_a_ball_is_found_from_its_whole_surface_or_half_of_it() -> None:
    points, _ = ball((3, -20, 5), 12.0)
    for seen in (points, points[points[:, 2] > 5]):
        found = fit_ball(seen)
        assert found is not None and found.radius == pytest.approx(12) and found.vertices == len(seen)
        np.testing.assert_allclose(found.centre, [3, -20, 5], atol=1e-6)


@pytest.mark.parametrize(("uneven", "round_"), [(0.05, True), (0.4, False)])
def test_what_is_uneven_or_flat_is_no_ball(uneven: float, round_: bool) -> None:
    points, _ = ball((0, 0, 0), 10.0, 200)
    bumpy = points * (1 + uneven * RNG.uniform(-1, 1, (200, 1)))
    assert (fit_ball(bumpy) is not None) == round_
    assert fit_ball(points[points[:, 2] > 8.6]) is None  # a cap, 1.02 radii wide
    assert fit_ball(points[points[:, 2] > 6.5]) is not None  # 1.5 wide


def test_the_two_largest_alike_and_as_far_apart_as_eyes_are_the_eyes() -> None:
    left, right = ball((32, 0, 0), 12.0), ball((-32, 0, 0), 12.0)
    buttons = ball((5, -90, 0), 3.0), ball((-5, -90, 0), 3.0)
    head = ball((0, 0, -60), 90.0, 200, stretch=3)
    found = eyeballs(*mesh(*buttons, head, right, left))
    assert found is not None and sorted(round(float(eye.centre[0])) for eye in found) == [-32, 32]
    assert [eye.radius for eye in found] == pytest.approx([12, 12])


@pytest.mark.parametrize(
    ("radius", "apart", "count", "stretch", "eyes"),
    [
        (12.0, 64.0, 60, 1.0, True),
        (13.5, 64.0, 60, 1.0, True),
        (14.1, 64.0, 60, 1.0, False),
        (10.2, 64.0, 60, 1.0, False),
        (12.0, 28.0, 60, 1.0, True),
        (12.0, 25.0, 60, 1.0, False),
        (12.0, 106.0, 60, 1.0, True),
        (12.0, 110.0, 60, 1.0, False),
        (12.0, 64.0, 20, 1.0, True),
        (12.0, 64.0, 19, 1.0, False),
        (12.0, 64.0, 60, 2.5, False),
    ],
)
def test_eyes_are_alike_in_size_and_far_enough_apart(radius, apart, count, stretch, eyes: bool) -> None:
    pair = mesh(ball((0, 0, 0), 12.0), ball((0, apart, 0), radius, count, stretch))
    assert (eyeballs(*pair) is not None) == eyes


def test_the_bundled_head_has_two_eyes() -> None:
    found = eyeballs(bundled().neutral.astype(float), bundled().triangles)
    assert found is not None
    centres = np.array(sorted((eye.centre for eye in found), key=lambda centre: centre[0]))
    np.testing.assert_allclose(centres[0] * [-1, 1, 1], centres[1], atol=0.5)
