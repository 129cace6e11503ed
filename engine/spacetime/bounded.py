"""Weights kept in a range: which of them rest on a bound is found by exchange, the rest solved for exactly."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from engine.spacetime.blocks import BlockCholesky
from engine.spacetime.matching import Bounds
from engine.spacetime.system import System
from engine.take import Array, Mask

WHOLE_ROUNDS = 6  # in which all weights that should change sides do; later ones draw lots, since exchange may cycle
ROUNDS = 80
NEWTON_ROUNDS = 200
TOLERANCE = 1e-9  # of a weight: how far beyond a bound, or how far the gradient may still ask to go
SUFFICIENT = 1e-4  # share of the promised decrease that a step must deliver
Tell = Callable[[float], None]  # is told the share that is done, 0..1; it may raise, to stop


def silent(_: float) -> None:
    """Tell nobody."""


class BoundedSolver:
    """Minimises ``W' H W / 2 - W' r`` over the weights that are not held, within bounds.

    Parameters
    ----------
    system : gives H
    held : (f, m) bool, weights that are given and not bounded
    bounds : of all others
    factorise : returns the factor of H over free weights, (f, m) bool
    tell : called each round; the weights that change sides become fewer, by about as large a share each time
    """

    def __init__(
        self,
        system: System,
        held: Mask,
        bounds: Bounds,
        factorise: Callable[[Mask], BlockCholesky],
        tell: Tell = silent,
    ) -> None:
        self._system, self._held, self._bounds, self._factorise = system, held, bounds, factorise
        self._tell = tell

    def solve(self, start: Array, right: Array) -> Array:
        """Return the minimiser, (f, m), from the unbounded one and a right side, (f, m)."""
        low, high = self._bounds.low, self._bounds.high
        if not self._beyond(start).any():
            return start
        side = np.where(self._held, 0, (start >= high).astype(np.int8) - (start <= low))
        rng = np.random.default_rng(0)
        first = most = 0.0
        for turn in range(ROUNDS):
            free = ~self._held & (side == 0)
            given = np.where(self._held, start, np.where(side > 0, high, low))
            weights = self._solve_free(free, given, right)
            slope = self._system.apply(weights) - right
            wanted = np.where(free, (weights > high + TOLERANCE).astype(np.int8) - (weights < low - TOLERANCE), side)
            wanted = np.where((side * slope > 0) & ~self._held, 0, wanted)  # the gradient leads back inside
            changes = wanted != side
            if not changes.any():
                return weights
            left = float(np.log1p(changes.sum()))
            first = first or left
            most = max(most, 1 - left / first)
            self._tell(most)
            side = np.where(changes & (rng.random(side.shape) < 0.5), wanted, side) if turn >= WHOLE_ROUNDS else wanted
        return self._newton(np.where(self._held, start, np.clip(weights, low, high)), right)

    def _beyond(self, weights: Array) -> Mask:
        return ~self._held & ((weights < self._bounds.low) | (weights > self._bounds.high))

    def _solve_free(self, free: Mask, given: Array, right: Array) -> Array:
        fixed = np.where(free, 0.0, given)
        return self._factorise(free).solve(np.where(free, right - self._system.apply(fixed), given))

    def _newton(self, weights: Array, right: Array) -> Array:
        """Return the minimiser by projected Newton steps (Bertsekas 1982), which end wherever they start.

        Weights at a bound that the gradient presses against it are left out of the step; the step is cut until the
        projected weights lower the cost enough.
        """
        low, high = self._bounds.low, self._bounds.high
        scale = np.diag(self._system.velocity_gram()) + np.diag(self._system.constant_gram())
        for _ in range(NEWTON_ROUNDS):
            self._tell(1.0)
            slope = np.where(self._held, 0.0, self._system.apply(weights) - right)
            wanted = np.clip(weights - slope / scale, low, high) - weights
            if np.abs(np.where(self._held, 0.0, wanted)).max() < TOLERANCE:
                break
            free = ~self._held & ~np.where(slope > 0, weights <= low, weights >= high)
            step = self._factorise(free).solve(np.where(free, -slope, 0.0))
            weights = self._search(weights, step, slope)
        return weights

    def _search(self, weights: Array, step: Array, slope: Array) -> Array:
        length = 1.0
        while True:
            moved = np.clip(weights + length * step, self._bounds.low, self._bounds.high)
            change = np.where(self._held, 0.0, moved - weights)
            promised = float((slope * change).sum())
            gained = promised + 0.5 * float((change * self._system.apply(change)).sum())
            if gained <= SUFFICIENT * promised or length < 1e-12:
                return weights + change
            length *= 0.5
