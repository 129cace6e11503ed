from __future__ import annotations

import numpy as np
import pytest

from engine.errors import EditError
from engine.manifold.patches import COTANGENTS, LabelSolver, alignment, cotangent_laplacian, rings, similar, windows


def grid(side: int = 7) -> tuple[np.ndarray, np.ndarray]:
    """A bumpy sheet: (n, 3) vertices and its triangles."""
    x, y = np.meshgrid(np.arange(side, dtype=float), np.arange(side, dtype=float), indexing="ij")
    vertices = np.stack([x, y, np.sin(x) * np.cos(y)], axis=-1).reshape(-1, 3)
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    lower = np.stack([corner, corner + side, corner + 1], axis=1)
    upper = np.stack([corner + 1, corner + side, corner + side + 1], axis=1)
    return vertices, np.concatenate([lower, upper])


def plain_alignment(points: np.ndarray, weights: np.ndarray, dimension: int, stiffness: float) -> np.ndarray:
    """Equation 13 patch by patch, with the least squares over D and c written out by the normal equations."""
    energy = np.zeros((len(points), len(points)))
    for row in weights:
        members = np.flatnonzero(row)
        share = row[members] / row[members].mean()
        mean = share @ points[members] / share.sum()
        root = np.diag(np.sqrt(share))
        left, extent, _ = np.linalg.svd(root @ (points[members] - mean), full_matrices=False)
        kept = extent > 1e-7 * extent[0]
        tangent = (left * extent)[:, kept][:, :dimension]
        constant = root @ np.ones((len(members), 1))
        design = np.hstack([constant, tangent])
        penalty = np.diag([0.0] + [stiffness * extent[0] ** 2] * tangent.shape[1])
        inner = np.linalg.solve(design.T @ design + penalty, design.T @ root)
        # min over (D, c) of |root y - design a|^2 + a^T penalty a is y^T (root root - root design inner) y
        local = root @ root - root @ design @ inner
        energy[np.ix_(members, members)] += local
    return energy


@pytest.mark.parametrize(("dimension", "stiffness"), [(3, 0.0), (2, 0.0), (2, 0.01), (3, 0.1)])
def test_alignment_equals_the_least_squares_of_each_patch(dimension: int, stiffness: float) -> None:
    vertices, triangles = grid()
    neighbourhoods = rings(triangles, vertices)
    made = alignment(vertices, neighbourhoods, dimension=dimension, stiffness=stiffness).toarray()
    plain = plain_alignment(vertices, neighbourhoods.toarray(), dimension, stiffness)
    np.testing.assert_allclose(made, plain, atol=1e-9)


@pytest.mark.parametrize("squash", [(1.0, 1.0, 0.0), (1.0, 1e-5, 1e-5), (1.0, 0.0, 0.0)])
def test_alignment_is_as_exact_where_patches_are_flat_or_a_line(squash: tuple[float, float, float]) -> None:
    vertices, triangles = grid()
    neighbourhoods = rings(triangles, vertices)
    thin = vertices * squash
    made = alignment(thin, neighbourhoods, dimension=2, stiffness=0.01).toarray()
    np.testing.assert_allclose(made, plain_alignment(thin, neighbourhoods.toarray(), 2, 0.01), atol=1e-9)


def test_the_laplacian_has_the_cotangents_of_the_angles_across_from_each_edge() -> None:
    vertices, triangles = grid()
    vertices = vertices * [1.0, 3.0, 1.0]  # some angles obtuse
    plain = np.zeros(2 * (len(vertices),))
    for triangle in triangles:
        for a, b, c in (np.roll(triangle, turn) for turn in range(3)):
            u, v = vertices[b] - vertices[a], vertices[c] - vertices[a]
            angle = np.arccos(u @ v / np.linalg.norm(u) / np.linalg.norm(v))
            weight = np.clip(0.5 / np.tan(angle), *COTANGENTS)
            plain[b, c] -= weight
            plain[c, b] -= weight
    plain -= np.diag(plain.sum(axis=1))
    np.testing.assert_allclose(cotangent_laplacian(vertices, triangles).toarray(), plain, atol=1e-9)


def test_without_stiffness_every_affine_motion_is_free_and_with_it_only_a_shift() -> None:
    vertices, triangles = grid()
    free = alignment(vertices, rings(triangles, vertices), dimension=3)
    stiff = alignment(vertices, rings(triangles, vertices), dimension=3, stiffness=0.01)
    affine = vertices @ np.array([[1.0, 2, 0], [0, -1, 3], [0.5, 0, 1]]) + [3, 4, 5]
    assert np.abs(free @ affine).max() < 1e-9
    assert np.abs(stiff @ np.ones((len(vertices), 1))).max() < 1e-9
    assert np.abs(stiff @ affine).max() > 1e-3


def test_collinear_neighbours_are_a_patch_of_one_direction() -> None:
    line = np.outer(np.arange(9.0), [1, 2, 3])
    energy = alignment(line, windows(9, size=5), dimension=3)
    assert np.isfinite(energy.data).all()
    solved = LabelSolver(energy, np.array([0, 8]), beta=1e6).solve(line[[0, 8]] * 2)
    np.testing.assert_allclose(solved, line * 2, atol=1e-6)


def test_windows_shift_inwards_at_the_ends_and_rings_follow_the_mesh() -> None:
    members = [set(row) for row in windows(6, size=3).indices.reshape(6, 3)]
    assert members == [{0, 1, 2}, {0, 1, 2}, {1, 2, 3}, {2, 3, 4}, {3, 4, 5}, {3, 4, 5}]
    vertices, triangles = grid(3)
    one, two = rings(triangles, vertices, size=1), rings(triangles, vertices, size=2)
    assert set(one[[0]].indices) == {0, 1, 3}
    assert set(two[[0]].indices) == {0, 1, 2, 3, 4, 6}


def test_like_frames_are_neighbours_however_far_apart_in_time() -> None:
    points = np.array([[0.0], [5.0], [10.0], [0.1], [5.1], [10.1]])
    members = [set(row) for row in similar(points, size=2).indices.reshape(6, 2)]
    assert members == [{0, 3}, {1, 4}, {2, 5}, {0, 3}, {1, 4}, {2, 5}]


def test_equal_points_each_lead_their_own_patch() -> None:
    neighbourhoods = similar(np.zeros((6, 2)), size=3)
    assert all(frame in neighbourhoods[[frame]].indices for frame in range(6))
    assert np.isfinite(neighbourhoods.data).all()


def test_the_solver_equals_the_dense_solve_of_equation_18() -> None:
    vertices, triangles = grid()
    energy = alignment(vertices, rings(triangles, vertices), dimension=2, stiffness=0.01)
    labelled, beta = np.array([3, 20, 40]), 7.0
    labels = np.random.default_rng(1).normal(size=(3, 10))
    held, asked = np.zeros((49, 49)), np.zeros((49, 10))
    held[labelled, labelled], asked[labelled] = beta, beta * labels
    solver = LabelSolver(energy, labelled, beta=beta)
    plain = np.linalg.solve(energy.toarray() + held, asked)
    np.testing.assert_allclose(solver.solve(labels), plain, atol=1e-8)
    np.testing.assert_allclose(solver.influence() @ labels, plain, atol=1e-8)


def test_labels_that_do_not_determine_the_rest_are_refused() -> None:
    vertices, triangles = grid()
    energy = alignment(vertices, rings(triangles, vertices), dimension=3)
    with pytest.raises(EditError, match="do not determine"):
        LabelSolver(energy, np.array([4]))
