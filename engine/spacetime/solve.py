"""Movement matching: weights that move a face as the source moves (SLS12)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engine.errors import EditError
from engine.spacetime.blocks import BlockCholesky
from engine.spacetime.modes import Modes
from engine.spacetime.system import System
from engine.take import Array, Mask

ROUNDS = 100  # of the bounded solve; each fixes and frees many weights at once, ten is typical
TOLERANCE = 1e-10  # of a weight: how far the gradient may still ask to go
SUFFICIENT = 1e-4  # share of the promised decrease that a step must deliver


@dataclass(frozen=True)
class Bounds:
    """The range that weights must stay in; pins may lie outside."""

    low: float = 0.0
    high: float = 1.0


class MovementMatcher:
    """Weights whose marker velocities match the source's (SLS12 eq. 2, 4, 5 and section 7.1).

    Minimises ``|D (B W)' - D S'|^2 + alpha prior(W) + beta |M (B W - S)|^2`` with the pinned weights of W given. Where
    all frames have the same terms and are pinned whole, the shapes separate into modes and each is a tridiagonal
    system, O(f m^2) in all; otherwise a block Cholesky, O(f m^3). Factorised here, once; `solve` only substitutes.

    Parameters
    ----------
    system : what is minimised
    held : (f, m) bool, pinned weights; None pins nothing
    bounds : range of the weights that are not pinned, or None

    Raises
    ------
    EditError : where neither a pin, nor the prior, nor a held place says where the motion starts
    """

    def __init__(self, system: System, held: Mask | None = None, *, bounds: Bounds | None = None) -> None:
        self._system, self._bounds = system, bounds
        self._held = np.zeros((system.frames, system.count), bool) if held is None else held
        whole = self._held.all(axis=1)
        self.separable = system.uniform and bool((self._held.any(axis=1) == whole).all())
        self._modes = Modes(system, whole) if self.separable else None
        self._cholesky = None if self.separable else self._factorise(~self._held)

    def _factorise(self, free: Mask) -> BlockCholesky:
        return BlockCholesky(self._system.blocks, self._system.frames, None if free.all() else free)

    def solve(self, source: Array, *, places: Array | None = None, values: Array | None = None) -> Array:
        """Return weights, (f, m).

        Parameters
        ----------
        source : (f, 3n) mm, displacement of the markers from rest
        places : (f, k) mm, where the rows of the system's position term are to be
        values : (f, m), of which the pinned ones count
        """
        check_source(source, self._system)
        return self.settle(self._system.right_side(source, places), values)

    def settle(self, right: Array, values: Array | None = None) -> Array:
        """Return weights, (f, m), of a right side as `System.right_side` gives it; zero where the source is at rest."""
        given = np.zeros_like(right) if values is None else np.where(self._held, values, 0.0)
        weights = self._unbounded(right, given)
        if self._bounds is None:
            return weights
        return self._within(weights, right, self._bounds)

    def _unbounded(self, right: Array, given: Array) -> Array:
        if self._modes is not None:
            return self._modes.solve(right, given)
        assert self._cholesky is not None
        if not self._held.any():
            return self._cholesky.solve(right)
        return self._cholesky.solve(np.where(self._held, given, right - self._system.apply(given)))

    def _within(self, start: Array, right: Array, bounds: Bounds) -> Array:
        """Return the minimiser within bounds by projected Newton steps (Bertsekas 1982) from the unbounded one.

        Weights at a bound that the gradient presses against it are left out of the step; the step is cut until the
        projected weights lower the cost enough, which makes the method finite.
        """
        scale = np.maximum(self._diagonal(), 1e-300)
        weights = np.where(self._held, start, np.clip(start, bounds.low, bounds.high))
        for _ in range(ROUNDS):
            slope = np.where(self._held, 0.0, self._system.apply(weights) - right)
            pressed = np.where(slope > 0, weights <= bounds.low, weights >= bounds.high)
            wanted = np.where(self._held, 0.0, np.clip(weights - slope / scale, bounds.low, bounds.high) - weights)
            if np.abs(wanted).max(initial=0.0) < TOLERANCE:
                return weights
            free = ~self._held & ~pressed
            step = self._factorise(free).solve(np.where(free, -slope, 0.0))
            weights = self._search(weights, step, slope, bounds)
        return weights

    def _search(self, weights: Array, step: Array, slope: Array, bounds: Bounds) -> Array:
        length = 1.0
        while True:
            moved = np.where(self._held, weights, np.clip(weights + length * step, bounds.low, bounds.high))
            change = moved - weights
            promised = float((slope * change).sum())
            gained = promised + 0.5 * float((change * self._system.apply(change)).sum())
            if gained <= SUFFICIENT * promised or length < 1e-12:
                return moved
            length *= 0.5

    def _diagonal(self) -> Array:
        """Return what each weight costs by itself, (f, m), to judge its gradient in its own unit."""
        ends = 2 * np.ones(self._system.frames)
        ends[[0, -1]] = 1
        own = np.diag(self._system.velocity_gram()), np.diag(self._system.constant_gram())
        return np.asarray(ends[:, None] * own[0] + own[1])


def check_source(source: Array, system: System) -> None:
    """Raise `EditError` where the source's displacements, (f, 3n) mm, do not fit a system or are not finite."""
    expected = (system.frames, len(system.basis))
    if source.shape != expected:
        raise EditError(f"The source has {source.shape} numbers where the shapes need {expected}.")
    if not np.isfinite(source).all():
        raise EditError("The source's markers have gaps that were not filled.", "Bridge them first.")
