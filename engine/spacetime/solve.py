"""Movement matching: weights whose marker velocities are the source's (SLS12)."""

from __future__ import annotations

import numpy as np

from engine.errors import EditError
from engine.spacetime import blocks
from engine.spacetime.blocks import BlockCholesky
from engine.spacetime.bounded import BoundedSolver, Progress, ignore
from engine.spacetime.matching import Bounds
from engine.spacetime.modes import Modes
from engine.spacetime.system import System
from engine.take import Array, Mask


class MovementMatcher:
    """Solves for weights whose marker velocities match the source's (SLS12 eq. 2, 4, 5 and section 7.1).

    Minimises ``|D (B W)' - D S'|^2 + alpha prior(W) + beta |M (B W - S)|^2`` with the pinned weights of W given. Where
    all frames have the same terms and are pinned whole, the shapes separate into modes and each is a tridiagonal
    system, O(f m^2) in all; otherwise a block Cholesky, O(f m^3). Factorised here, once; `solve` only substitutes.

    Parameters
    ----------
    system : what is minimised
    fixed : (f, m) bool, pinned weights; None for none
    bounds : range of the weights that are not pinned, or None
    progress : called with the share of a bounded solve that is done, 0..1; it may raise, to stop

    Raises
    ------
    EditError : where neither a pin, nor the prior, nor a position determines where the motion starts
    """

    def __init__(
        self, system: System, fixed: Mask | None = None, *, bounds: Bounds | None = None, progress: Progress = ignore
    ) -> None:
        self._system, self._bounds, self._progress, self._share = system, bounds, progress, 0.0
        self._cache: dict[int, tuple[Array, Array]] = {}
        self._fixed = np.zeros((system.frames, system.count), bool) if fixed is None else fixed
        whole: Mask = np.asarray(self._fixed.all(axis=1))
        self.separable = system.uniform and bool((self._fixed.any(axis=1) == whole).all())
        self._modes = Modes(system, whole) if self.separable else None
        self._cholesky = None if self.separable else self._factorise(~self._fixed)

    def _factorise(self, free: Mask) -> BlockCholesky:
        return BlockCholesky(self._blocks, self._system.frames, None if free.all() else free)

    def _blocks(self, start: int, stop: int) -> tuple[Array, Array]:
        """Return the system's blocks, cached for the bounded solve of a take that is not long."""
        self._progress(self._share)  # so that a long take, too, can be stopped within a second
        if self._bounds is None or self._system.frames > blocks.TUNING.kept_frames:
            return self._system.blocks(start, stop)
        if start not in self._cache:
            self._cache[start] = self._system.blocks(start, stop)
        return self._cache[start]

    def _report(self, share: float) -> None:
        self._share = share
        self._progress(share)

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
        """Return weights, (f, m), for a right side as `System.right_side` gives it; zero where the source is at rest."""
        given = np.zeros_like(right) if values is None else np.where(self._fixed, values, 0.0)
        weights = self._unbounded(right, given)
        if self._bounds is None:
            return weights
        return BoundedSolver(self._system, self._fixed, self._bounds, self._factorise, self._report).solve(
            weights, right
        )

    def _unbounded(self, right: Array, given: Array) -> Array:
        if self._modes is not None:
            return self._modes.solve(right, given)
        assert self._cholesky is not None
        if not self._fixed.any():
            return self._cholesky.solve(right)
        return self._cholesky.solve(np.where(self._fixed, given, right - self._system.apply(given)))


def check_source(source: Array, system: System) -> None:
    """Raise `EditError` where the source's displacements, (f, 3n) mm, do not fit a system or are not finite."""
    expected = (system.frames, len(system.basis))
    if source.shape != expected:
        raise EditError(f"The source has {source.shape} numbers where the shapes need {expected}.")
    if not np.isfinite(source).all():
        raise EditError("The source's markers have gaps that were not filled.", "Bridge them first.")
