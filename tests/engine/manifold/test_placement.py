from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csgraph

from engine.errors import EditError
from engine.manifold.placement import SPACE_SHARE, place_points
from tests.engine.manifold.test_patches import grid


def plain(
    vertices: np.ndarray, triangles: np.ndarray, motions: np.ndarray, count: int, allowed: np.ndarray
) -> list[int]:
    """Farthest points one after the other, by the shortest ways over edges of an explicit table."""
    edges = np.zeros((len(vertices), len(vertices)))
    for triangle in triangles:
        for a, b in zip(triangle, np.roll(triangle, 1), strict=True):
            unlike = np.sqrt(((motions[:, a] - motions[:, b]) ** 2).sum(axis=1).mean())
            edges[a, b] = edges[b, a] = unlike + SPACE_SHARE * np.linalg.norm(vertices[a] - vertices[b]) + 1e-9
    ways = csgraph.shortest_path(edges)
    where = np.flatnonzero(allowed)
    chosen = [int(where[np.argmin((motions**2).sum(axis=(0, 2))[where])])]
    while len(chosen) < count:
        chosen.append(int(where[np.argmax(ways[chosen][:, where].min(axis=0))]))
    return chosen


@pytest.mark.parametrize("seed", range(3))
def test_points_are_placed_as_by_a_plain_search(seed: int) -> None:
    rng = np.random.default_rng(seed)
    vertices, triangles = grid()
    vertices = vertices * 10 + rng.normal(0, 0.5, vertices.shape)
    motions, allowed = rng.normal(0, 1, (4, 49, 3)), rng.random(49) < 0.7
    for where in (allowed, np.ones(49, bool)):
        made = place_points(vertices, triangles, motions, 9, allowed=where)
        assert made.tolist() == plain(vertices, triangles, motions, 9, where)
        assert len(set(made.tolist())) == 9 and where[made].all()
    assert place_points(vertices, triangles, motions, 9).tolist() == plain(
        vertices, triangles, motions, 9, np.ones(49, bool)
    )


def test_every_part_of_a_mesh_gets_a_point_and_no_more_points_than_places() -> None:
    vertices, triangles = grid(3)
    both = np.concatenate([vertices, vertices + 100]), np.concatenate([triangles, triangles + 9])
    made = place_points(*both, np.random.default_rng(0).normal(size=(2, 18, 3)), 2)
    assert sorted(made // 9) == [0, 1]
    allowed = np.arange(18) < 3
    assert len(place_points(*both, np.zeros((1, 18, 3)), 3, allowed=allowed)) == 3
    with pytest.raises(EditError, match="4 feature points cannot be placed on 3 vertices"):
        place_points(*both, np.zeros((1, 18, 3)), 4, allowed=allowed)
