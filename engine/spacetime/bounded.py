"""Bounded least squares by an active-set method: exchange of the weights at a bound, an exact solve for the others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from engine.spacetime.blocks import BlockCholesky
from engine.spacetime.matching import Bounds
from engine.spacetime.system import System
from engine.take import Array, Mask

Progress = Callable[[float], None]  # is called with the share that is done, 0..1; it may raise, to stop


@dataclass(frozen=True)
class Tuning:
    """Limits of the iteration; ranges tried were not recorded."""

    whole_rounds: int = (
        6  # rounds in which all weights change sides; later a random half does, since exchange may cycle
    )
    rounds: int = 80  # of exchange, before projected Newton steps take over
    newton_rounds: int = 200
    tolerance: float = 1e-9  # weight, by which bounds and the gradient's step may be missed
    sufficient: float = 1e-4  # share of the predicted decrease that a step must give (Armijo)
    shortest_step: float = 1e-12  # of the line search


TUNING = Tuning()


def ignore(_: float) -> None:
    """Ignore the progress."""


class BoundedSolver:
    """Minimises ``W' H W / 2 - W' r`` over the weights that are not fixed, within bounds.

    Parameters
    ----------
    system : gives H
    fixed : (f, m) bool, weights with a given value, which the bounds leave alone
    bounds : of all others
    factorise : returns the factor of H over free weights, (f, m) bool
    progress : called each round; the number of weights that change sides shrinks by about the same factor each time
    """

    def __init__(
        self,
        system: System,
        fixed: Mask,
        bounds: Bounds,
        factorise: Callable[[Mask], BlockCholesky],
        progress: Progress = ignore,
    ) -> None:
        self._system, self._fixed, self._bounds, self._factorise = system, fixed, bounds, factorise
        self._progress = progress

    def solve(self, start: Array, right: Array) -> Array:
        """Return the minimiser, (f, m), from the unbounded one and a right side, (f, m)."""
        low, high = self._bounds.low, self._bounds.high
        if not self._beyond(start).any():
            return start
        side = np.where(self._fixed, 0, (start >= high).astype(np.int8) - (start <= low))
        rng = np.random.default_rng(0)
        first = most = 0.0
        for turn in range(TUNING.rounds):
            free = ~self._fixed & (side == 0)
            given = np.where(self._fixed, start, np.where(side > 0, high, low))
            weights = self._solve_free(free, given, right)
            slope = self._system.apply(weights) - right
            sides = np.where(
                free, (weights > high + TUNING.tolerance).astype(np.int8) - (weights < low - TUNING.tolerance), side
            )
            sides = np.where((side * slope > 0) & ~self._fixed, 0, sides)  # the gradient leads back inside
            changes = sides != side
            if not changes.any():
                return weights
            left = float(np.log1p(changes.sum()))
            first = first or left
            most = max(most, 1 - left / first)
            self._progress(most)
            side = (
                np.where(changes & (rng.random(side.shape) < 0.5), sides, side)
                if turn >= TUNING.whole_rounds
                else sides
            )
        return self._newton(np.where(self._fixed, start, np.clip(weights, low, high)), right)

    def _beyond(self, weights: Array) -> Mask:
        return ~self._fixed & ((weights < self._bounds.low) | (weights > self._bounds.high))

    def _solve_free(self, free: Mask, given: Array, right: Array) -> Array:
        boundary = np.where(free, 0.0, given)
        return self._factorise(free).solve(np.where(free, right - self._system.apply(boundary), given))

    def _newton(self, weights: Array, right: Array) -> Array:
        """Return the minimiser by projected Newton steps (Bertsekas 1982), which converge from any start.

        Weights at a bound that the gradient presses against it are left out of the step; the step is cut until the
        projected weights lower the cost enough.
        """
        low, high = self._bounds.low, self._bounds.high
        scale = np.diag(self._system.velocity_gram()) + np.diag(self._system.constant_gram())
        for _ in range(TUNING.newton_rounds):
            self._progress(1.0)
            slope = np.where(self._fixed, 0.0, self._system.apply(weights) - right)
            projected = np.clip(weights - slope / scale, low, high) - weights
            if np.abs(np.where(self._fixed, 0.0, projected)).max() < TUNING.tolerance:
                break
            free = ~self._fixed & ~np.where(slope > 0, weights <= low, weights >= high)
            step = self._factorise(free).solve(np.where(free, -slope, 0.0))
            weights = self._search(weights, step, slope)
        return weights

    def _search(self, weights: Array, step: Array, slope: Array) -> Array:
        length = 1.0
        while True:
            moved = np.clip(weights + length * step, self._bounds.low, self._bounds.high)
            change = np.where(self._fixed, 0.0, moved - weights)
            predicted = float((slope * change).sum())
            decrease = predicted + 0.5 * float((change * self._system.apply(change)).sum())
            if decrease <= TUNING.sufficient * predicted or length < TUNING.shortest_step:
                return weights + change
            length *= 0.5
