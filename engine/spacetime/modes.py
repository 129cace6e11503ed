"""Modal decoupling: where every frame has the same terms, shapes separate into modes with a tridiagonal system each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.linalg import eigh
from scipy.linalg.lapack import dpttrf, dpttrs

from engine.errors import EditError
from engine.spacetime.system import System
from engine.take import Array, Mask


@dataclass(frozen=True)
class Tuning:
    """Tolerance of the decoupling; any value this small will do."""

    negligible: float = 1e-10  # share of a mode's cost below which its position is undetermined


TUNING = Tuning()


class Modes:
    """Solves ``L W V + W K = R`` with whole frames of W fixed; L is the path Laplacian, V and K as `System` gives them.

    The generalised eigenvectors T of K and V + K make both diagonal: ``T'VT = I - theta``, ``T'KT = theta``. Then each
    column of ``Z = W T'^(-1)`` solves ``((1 - theta) L + theta I) z = r`` on its own, O(f). All m systems stand one after
    the other in one factorisation, done here; `solve` only substitutes.

    Parameters
    ----------
    system : its frames must be `uniform`
    fixed : (f,) bool, frames whose weights are given

    Raises
    ------
    EditError : where no pin, prior or position determines where the motion starts
    """

    def __init__(self, system: System, fixed: Mask) -> None:
        place, total = system.constant_gram(), system.velocity_gram()
        total = total + place
        share, self._modes = eigh(place, total)
        self._share = np.clip(share, 0.0, 1.0)
        if not fixed.any() and self._share[0] < TUNING.negligible:
            raise EditError("Nothing says where the motion starts.", "Pin a frame, or give the prior some strength.")
        self._fixed = fixed
        self._neighbours = _touching(fixed)
        self._to_modes = total @ self._modes  # W T'^(-1) = W (V + K) T
        self._pivots, self._couplings = self._factorise()

    def _factorise(self) -> tuple[Array, Array]:
        frames, stiffness = len(self._fixed), (1 - self._share)[:, None]
        degree = np.full(frames, 2.0)
        degree[0] -= 1
        degree[-1] -= 1
        diagonal = stiffness * degree + self._share[:, None]
        coupling = np.repeat(-stiffness, frames, axis=1)
        coupling[:, -1] = 0.0  # modes are independent
        diagonal[:, self._fixed] = 1.0
        coupling[:, self._fixed] = 0.0
        coupling[:, :-1][:, self._fixed[1:]] = 0.0
        pivots, factor, failed = dpttrf(diagonal.ravel(), coupling.ravel()[:-1])
        if failed:
            raise EditError("The pins and the prior leave the motion undetermined.", "Pin a frame.")
        return pivots, factor

    def solve(self, right: Array, values: Array) -> Array:
        """Return weights, (f, m), of a right side, (f, m), and values, (f, m), of which the fixed rows count."""
        modal = np.ascontiguousarray((right @ self._modes).T)
        if len(self._neighbours):
            boundary = values[self._fixed] @ self._to_modes
            given = np.zeros((len(self._fixed), modal.shape[0]))
            given[self._fixed] = boundary
            modal[:, self._neighbours] += ((1 - self._share) * _sum_beside(given, self._neighbours)).T
            modal[:, self._fixed] = boundary.T
        solved, _ = dpttrs(self._pivots, self._couplings, modal.reshape(-1, 1), overwrite_b=1)
        weights = solved.reshape(modal.shape).T @ self._modes.T
        weights[self._fixed] = values[self._fixed]
        return np.asarray(weights)


def _touching(fixed: Mask) -> npt.NDArray[np.int64]:
    """Return the fixed frames and those beside them."""
    spread = fixed.copy()
    spread[1:] |= fixed[:-1]
    spread[:-1] |= fixed[1:]
    return np.flatnonzero(spread)


def _sum_beside(given: Array, frames: npt.NDArray[np.int64]) -> Array:
    padded = np.pad(given, ((1, 1), (0, 0)))
    return np.asarray(padded[frames] + padded[frames + 2])
