"""What topology-preserving transfer is measured against: radial basis functions and Laplacian editing.

Settings of each were chosen on training takes and other identities than those of the table, as the method's own were.
For driving: kernels r, r^3, multiquadric and Gaussian; uniform and cotangent Laplacians, with and without vertex areas,
label weights 0.1 to 1e5. For retargeting: kernels r and Gaussian, of all points at once or of each by itself, with and
without the first guess; first and second differences.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from engine.manifold.patches import LabelSolver, cotangent_laplacian
from engine.take import Array

LABEL_WEIGHT = 1e3


def rbf_influence(rest: Array, points: npt.NDArray[np.int64]) -> Array:
    """Return how far each point moves each vertex, (n, m), with kernel r and an affine term (ZLL17 [16])."""
    centres = rest[points]
    system = np.block([[_distances(centres, centres), _affine(centres)], [_affine(centres).T, np.zeros((4, 4))]])
    target = np.eye(len(points) + 4)[:, : len(points)]
    return np.asarray(np.hstack([_distances(rest, centres), _affine(rest)]) @ np.linalg.solve(system, target))


def _affine(points: Array) -> Array:
    return np.hstack([np.ones((len(points), 1)), points])


def _distances(each: Array, other: Array) -> Array:
    return np.asarray(np.linalg.norm(each[:, None] - other[None], axis=2))


def laplacian_influence(rest: Array, triangles: npt.NDArray[np.integer], points: npt.NDArray[np.int64]) -> Array:
    """Return how far each point moves each vertex, (n, m): differential coordinates kept (Sorkine 2004, ZLL17 [17])."""
    laplacian = cotangent_laplacian(rest, triangles)
    return LabelSolver(sp.csc_array(laplacian.T @ laplacian), points, beta=LABEL_WEIGHT).influence()


def _first_guess(source: Array, source_rest: Array, target_rest: Array) -> Array:
    spread = [np.linalg.norm(rest - rest.mean(axis=0)) for rest in (target_rest, source_rest)]
    return np.asarray(target_rest + spread[0] / spread[1] * (source - source_rest))


def rbf_retarget(source: Array, source_rest: Array, target_rest: Array, labels: dict[int, Array]) -> Array:
    """Return target points, (frames, n, 3): each point's correction interpolated over the source point's places.

    Rest is a label as well, as it is for our method: with two labels the error is a quarter less than without.
    """
    guess = _first_guess(source, source_rest, target_rest)
    frames = np.array(sorted(labels))
    asked = np.stack([labels[int(frame)] for frame in frames])
    missing = np.concatenate([asked - guess[frames], np.zeros_like(target_rest)[None]])
    centres = np.concatenate([source[frames], source_rest[None]])
    result, size = guess.copy(), len(centres)
    for point in range(source.shape[1]):
        within = -_distances(centres[:, point], centres[:, point])
        system = np.block([[within, np.ones((size, 1))], [np.ones((1, size)), np.zeros((1, 1))]])
        share = np.linalg.lstsq(system, np.vstack([missing[:, point], np.zeros((1, 3))]), rcond=1e-10)[0]
        result[:, point] += share[-1] - _distances(source[:, point], centres[:, point]) @ share[:-1]
    return result


def laplacian_retarget(source: Array, source_rest: Array, target_rest: Array, labels: dict[int, Array]) -> Array:
    """Return target points, (frames, n, 3): the source's second differences in time kept."""
    guess = _first_guess(source, source_rest, target_rest)
    frames = np.array(sorted(labels))
    second = np.diff(np.eye(len(source)), n=2, axis=0)
    solver = LabelSolver(sp.csc_array(second.T @ second), frames, beta=LABEL_WEIGHT)
    missing = (np.stack([labels[int(frame)] for frame in frames]) - guess[frames]).reshape(len(frames), -1)
    return np.asarray(guess + solver.solve(missing).reshape(guess.shape))
