"""Which poses a face is likely to take: a normal distribution found by PCA (SLS12 section 5)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engine.errors import EditError
from engine.take import Array

FLOOR = 1e-4  # smallest variance, relative to the largest: directions that no example shows stay possible, at a price


@dataclass(frozen=True, eq=False)
class Prior:
    """Minus twice the logarithm of how likely weights are: ``|factor w - offset|^2``, without unit.

    Attributes
    ----------
    factor : (h, m), ``Lambda^(-1/2) E' B``
    offset : (h,), the mean pose in the same coordinates; zero for a prior about the face at rest
    """

    factor: Array
    offset: Array

    def cost(self, weights: Array) -> Array:
        """Return how unlikely each frame is, (frames,), of weights, (frames, m)."""
        return np.asarray(((weights @ self.factor.T - self.offset) ** 2).sum(axis=1))

    def scale(self, basis: Array) -> float:
        """Return what alpha is multiplied by so that it means the same on any head with any number of markers.

        An alpha of one then costs the average shape as much for being there as the match costs it for getting there
        in one frame. In mm^2.
        """
        return float((basis**2).sum() / max(float((self.factor**2).sum()), 1e-300))


def from_poses(basis: Array, poses: Array, *, about_rest: bool = True) -> Prior:
    """Return the prior of a basis, (3n, m) mm, from example weights, (poses, m), by PCA of what they do to markers.

    About the face at rest, or about the mean of the examples as in the paper; the mean of all shapes is a grimace
    that a face at rest would be drawn towards. Shapes that cancel, such as a jaw to the left and to the right, move no
    marker; they are kept as small as the examples' weights. Raises `EditError` where the examples move nothing.
    """
    mean = np.zeros(basis.shape[1]) if about_rest else poses.mean(axis=0)
    squares, vectors = np.linalg.eigh(basis.T @ basis)
    known = squares > 1e-12 * max(float(squares[-1]), 1e-300)
    directions = vectors.T
    to_markers = np.sqrt(squares[known, None]) * directions[known]  # (r, m): orthogonal coordinates of marker space
    coordinates = (poses - mean) @ to_markers.T
    values, vectors = np.linalg.eigh(coordinates.T @ coordinates / len(poses))
    if not len(values) or values[-1] <= 0:
        raise EditError("The prior's examples move no marker.", "Give it takes or shapes that move the face.")
    whitening = vectors / np.sqrt(np.maximum(values, FLOOR * values[-1]))
    cancelling = directions[~known] / np.sqrt((poses**2).mean())
    factor = np.vstack([whitening.T @ to_markers, cancelling])
    return Prior(factor, factor @ mean)


def from_shapes(basis: Array, *, about_rest: bool = True) -> Prior:
    """Return the prior whose examples are the shapes themselves, each once: what a well-made character affords."""
    return from_poses(basis, np.eye(basis.shape[1]), about_rest=about_rest)
