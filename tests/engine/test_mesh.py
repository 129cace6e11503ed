from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse.csgraph import connected_components

from engine.character import bundled
from engine.errors import EditError
from engine.mesh import adjacency, parts_of

VERTICES = 12
meshes = st.lists(st.lists(st.integers(0, VERTICES - 1), min_size=3, max_size=3, unique=True), max_size=10).map(
    lambda rows: np.array(rows, np.int32).reshape(-1, 3)
)


def plainly_adjacent(triangles: np.ndarray, vertices: int) -> np.ndarray:
    joined = np.zeros((vertices, vertices))
    for a, b, c in triangles.tolist():
        for one, other in ((a, b), (b, c), (c, a)):
            joined[one, other] = joined[other, one] = 1.0
    return joined


@given(meshes)
def test_neighbours_are_the_ends_of_sides(triangles: np.ndarray) -> None:
    found = adjacency(triangles, VERTICES)
    np.testing.assert_array_equal(found.toarray(), plainly_adjacent(triangles, VERTICES))
    assert found.dtype == np.float64


@given(meshes)
def test_parts_are_those_of_a_walk_numbered_by_first_sight(triangles: np.ndarray) -> None:
    joined, part, count = plainly_adjacent(triangles, VERTICES), np.full(VERTICES, -1), 0
    for start in range(VERTICES):
        if part[start] < 0:
            reached = [start]
            while reached:
                part[reached[0]] = count
                reached += [v for v in np.flatnonzero(joined[reached[0]]).tolist() if part[v] < 0 and v not in reached]
                reached.pop(0)
            count += 1
    np.testing.assert_array_equal(parts_of(triangles, VERTICES), part)


def test_the_bundled_head_has_the_parts_that_scipy_finds() -> None:
    head = bundled()
    ends = np.concatenate([head.triangles[:, [0, 1]], head.triangles[:, [1, 2]]])
    links = sp.coo_array((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=2 * (len(head.neutral),))
    np.testing.assert_array_equal(
        parts_of(head.triangles, len(head.neutral)), connected_components(links, directed=False)[1]
    )


@pytest.mark.parametrize("index", [-1, 3])
def test_an_index_that_no_vertex_has_is_a_sentence(index: int) -> None:
    with pytest.raises(EditError, match="beyond the mesh's 3"):
        adjacency(np.array([[0, 1, index]]), 3)
