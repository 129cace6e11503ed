"""The quadratic form of movement matching, as an operator and as blocks, never assembled (SLS12 eq. 4, 5)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engine.errors import EditError
from engine.spacetime.prior import Prior
from engine.take import Array


@dataclass(frozen=True)
class Tuning:
    """Regularisation of the quadratic form; any value this small will do."""

    # Stiffness relative to the average shape: decides only shapes that move no marker, which then follow their pins.
    stiffness: float = 1e-7


TUNING = Tuning()


@dataclass(frozen=True, eq=False)
class Position:
    """The position term: points, or differences of points, with target positions (SLS12 section 7.1).

    Attributes
    ----------
    rows : (k, m) mm per unit of weight; rows of the basis, or differences of them such as the gap between the lips
    weights : (k,) for all frames alike, or (f, k) frame by frame; beta in the paper
    """

    rows: Array
    weights: Array


@dataclass(frozen=True, eq=False)
class System:
    """``|C D (W B' - S)|^2 + stiffness |D W|^2 + alpha prior(W) + |beta^(1/2) (W P' - T)|^2`` over W, (f, m).

    D is the difference of neighbouring frames, B the basis, P the rows of `position`, S and T the source's displacements.

    Attributes
    ----------
    basis : (3n, m) mm; marker displacement per unit of weight
    frames : f
    prior : of one frame, or None
    alpha : its strength, already in the unit of the match
    position : the position term, or None
    confidence : (f - 1, 3n) in 0..1, weight of each coordinate's step to the next frame; None for 1 throughout
    stiffness : cost of a shape's own velocity, relative to the average shape's cost for its markers'
    """

    basis: Array
    frames: int
    prior: Prior | None = None
    alpha: float = 0.0
    position: Position | None = None
    confidence: Array | None = None
    stiffness: float = TUNING.stiffness

    def __post_init__(self) -> None:
        if not np.isfinite(self.basis).all():
            raise EditError("The shapes move a marker by something that is not a finite number.")

    @property
    def count(self) -> int:
        """Return m, the number of shapes."""
        return int(self.basis.shape[1])

    @property
    def uniform(self) -> bool:
        """Return whether every frame has the same terms, so that time and shapes separate."""
        return self.confidence is None and (self.position is None or self.position.weights.ndim == 1)

    def velocity_gram(self) -> Array:
        """Return the quadratic form of a step in time of the weights where all markers are seen, (m, m)."""
        gram = self.basis.T @ self.basis
        return np.asarray(gram + self._own * np.eye(self.count))

    @property
    def _own(self) -> float:
        return self.stiffness * max(float((self.basis**2).sum()) / max(self.count, 1), 1e-12)

    def constant_gram(self) -> Array:
        """Return the quadratic form of each frame's weights, (m, m): the prior, and positions if uniform."""
        gram = np.zeros((self.count, self.count))
        if self.prior is not None:
            gram += self.alpha * (self.prior.factor.T @ self.prior.factor)
        if self.position is not None and self.position.weights.ndim == 1:
            gram += self.position.rows.T @ (self.position.weights[:, None] * self.position.rows)
        return gram

    def right_side(self, source: Array, places: Array | None = None) -> Array:
        """Return minus the gradient at W = 0, (f, m), for source displacements, (f, 3n) mm, and places, (f, k) mm."""
        if self.confidence is None:
            moved = np.diff(source @ self.basis, axis=0)
        else:
            moved = (np.diff(source, axis=0) * self.confidence) @ self.basis
        right = np.zeros((self.frames, self.count))
        right[1:] += moved
        right[:-1] -= moved
        if self.prior is not None:
            right += self.alpha * (self.prior.offset @ self.prior.factor)
        if self.position is not None and places is not None:
            right += (places * self.position.weights) @ self.position.rows
        return right

    def apply(self, weights: Array) -> Array:
        """Return half the Hessian times weights, (f, m)."""
        applied = weights @ self.constant_gram()
        steps = np.diff(weights, axis=0)
        moved = steps @ self.velocity_gram()
        if self.confidence is not None:
            moved = ((steps @ self.basis.T) * self.confidence) @ self.basis + self._own * steps
        applied[1:] += moved
        applied[:-1] -= moved
        if self.position is not None and self.position.weights.ndim == 2:
            applied += ((weights @ self.position.rows.T) * self.position.weights) @ self.position.rows
        return np.asarray(applied)

    def blocks(self, start: int, stop: int) -> tuple[Array, Array]:
        """Return diagonal blocks, (stop - start, m, m), of frames [start, stop), and their coupling to the next frame.

        The coupling of the last frame of all is zero.
        """
        first, last = max(start - 1, 0), min(stop, self.frames - 1)
        steps = self._step_grams(first, last)  # step t enters frames t and t + 1
        diagonal = np.repeat(self.constant_gram()[None], stop - start, axis=0)
        coupling = np.zeros_like(diagonal)
        ahead, behind, offset = steps[start - first :], steps[: stop - 1 - first], first + 1 - start
        diagonal[: len(ahead)] += ahead
        diagonal[offset : offset + len(behind)] += behind
        coupling[: len(ahead)] = -ahead
        if self.position is not None and self.position.weights.ndim == 2:
            diagonal += _weighted_grams(self.position.rows, self.position.weights[start:stop])
        return diagonal, coupling

    def _step_grams(self, first: int, last: int) -> Array:
        """Return the quadratic forms of the steps t -> t + 1, first <= t < last, (last - first, m, m)."""
        if self.confidence is None:
            return np.broadcast_to(self.velocity_gram(), (last - first, self.count, self.count))
        return _weighted_grams(self.basis, self.confidence[first:last]) + self._own * np.eye(self.count)


def _weighted_grams(rows: Array, weights: Array) -> Array:
    """Return ``rows' diag(w) rows``, (f, m, m), for each row of weights, (f, k), computing equal rows once."""
    distinct, index = np.unique(weights, axis=0, return_inverse=True)
    grams = np.matmul(rows.T[None] * distinct[:, None, :], rows)
    return np.asarray(grams[index.reshape(-1)])
