"""The prior over poses: a normal distribution by PCA (SLS12 section 5)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engine.errors import EditError
from engine.take import Array


@dataclass(frozen=True)
class Tuning:
    """Regularisation of the prior; range tried not recorded."""

    floor: float = 1e-4  # smallest variance, relative to the largest, so that unseen directions stay possible


TUNING = Tuning()


@dataclass(frozen=True, eq=False)
class Prior:
    """The negative log-likelihood of weights, twice and up to a constant: ``|factor w - offset|^2``, without unit.

    Attributes
    ----------
    factor : (h, m), ``Lambda^(-1/2) E' B``
    offset : (h,), the mean pose in the same coordinates; zero for a prior about the face at rest
    """

    factor: Array
    offset: Array

    def cost(self, weights: Array) -> Array:
        """Return the cost of each frame, (frames,), of weights, (frames, m)."""
        return np.asarray(((weights @ self.factor.T - self.offset) ** 2).sum(axis=1))

    def scale(self, basis: Array) -> float:
        """Return the factor, in mm^2, that makes alpha independent of the head and its number of markers.

        With an alpha of 1 the prior then costs the average shape as much as the match costs its motion there in one frame.
        """
        return float((basis**2).sum() / max(float((self.factor**2).sum()), 1e-300))


def from_poses(basis: Array, poses: Array, *, about_rest: bool = True) -> Prior:
    """Return the prior of a basis, (3n, m) mm, from example weights, (poses, m), by PCA of their marker displacements.

    About the face at rest, or about the mean of the examples as in the paper; the mean of all shapes is a grimace
    that would attract a face at rest. Shapes that cancel, such as a jaw to the left and to the right, move no
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
    whitening = vectors / np.sqrt(np.maximum(values, TUNING.floor * values[-1]))
    cancelling = directions[~known] / np.sqrt((poses**2).mean())
    factor = np.vstack([whitening.T @ to_markers, cancelling])
    return Prior(factor, factor @ mean)


def from_shapes(basis: Array, *, about_rest: bool = True) -> Prior:
    """Return the prior whose examples are the shapes themselves, each once."""
    return from_poses(basis, np.eye(basis.shape[1]), about_rest=about_rest)
