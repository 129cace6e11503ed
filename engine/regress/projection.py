"""The smallest change of a face that reaches asked control values, measured as recorded faces vary."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from engine.controls import ALL_INDEX
from engine.extended import FaceMeasurer
from engine.take import Array, Mask

Columns = npt.NDArray[np.int64]
_LIPS = ALL_INDEX["lips_vertical"]  # lids have too few shapes to meet point on point, and would go wide while shut


@dataclass(frozen=True)
class Steps:
    """Tuned constants of Levenberg and Marquardt's steps.

    Attributes
    ----------
    rounds : at most
    first, least : damping, mm^2 [1e-4..1e-1]; close to a contact, where distances have no slope, Gauss-Newton alone would
        throw the lids past each other
    less, more : factor of the damping after a step that came nearer, and after one that did not
    releases : times that weights which a step would push beyond their limit are left out of it and it is taken anew
    contact_mm : asked distances shorter than this are met point on point [0.5..3]
    met_mm : a miss that is none
    """

    rounds: int = 14
    first: float = 1e-2
    least: float = 1e-6
    less: float = 0.05
    more: float = 10.0
    releases: int = 4
    contact_mm: float = 1.5
    met_mm: float = 1e-4


STEPS = Steps()


def project(
    weights: Array, asked: Array, columns: Columns, *, hold: Mask, covariance: Array, measurer: FaceMeasurer
) -> Array:
    """Return weights, (frames, 52), near `weights` whose controls reach `asked`, (frames, columns), where `hold` says so.

    Minimises ``|w - weights|^2`` in the metric of the inverse covariance, subject to C(w) = asked, frame by frame: each
    step is ``S J^T (J S J^T + d)^-1 (asked - C)``, S the covariance of the weights that may move, and is taken only where
    it comes nearer. Weights stay in 0..1, or at the recorded value where a take lies outside; one that has met its
    limit and would go further is left out of the step.

    Parameters
    ----------
    covariance : (52, 52), zero in the rows and columns of weights that shall not move
    """
    current = np.array(weights)
    low, high = np.minimum(weights, 0.0), np.maximum(weights, 1.0)
    active = np.flatnonzero(hold.any(axis=1))
    damping = np.full(len(weights), STEPS.first)
    goal = _Goal(measurer, columns, asked, hold)
    miss, slope = goal.at(current[active], active)
    for _ in range(STEPS.rounds):
        far = np.abs(miss).max(axis=1, initial=0.0) > STEPS.met_mm
        if not far.any():
            break
        active, miss, slope = active[far], miss[far], slope[far]
        bounds = (low[active], high[active])
        step = _step(slope, miss, damping[active], covariance=covariance, at=(current[active], *bounds))
        tried = np.clip(current[active] + step, *bounds)
        left, next_slope = goal.at(tried, active)
        nearer = (left**2).sum(axis=1) < (miss**2).sum(axis=1)
        current[active[nearer]] = tried[nearer]
        miss, slope = np.where(nearer[:, None], left, miss), np.where(nearer[:, None, None], next_slope, slope)
        damping[active] = np.maximum(damping[active] * np.where(nearer, STEPS.less, STEPS.more), STEPS.least)
    return current


class _Goal:
    """What is still missing, and by which slopes it is to be had.

    Close to nothing a distance has no slope but along itself, and points would circle each other: where one as short as
    `STEPS.contact_mm` is asked for, its three coordinates are, along the direction it has.
    """

    def __init__(self, measurer: FaceMeasurer, columns: Columns, asked: Array, hold: Mask) -> None:
        self._measurer, self._columns, self._asked = measurer, columns, asked
        short: Mask = hold & (columns == _LIPS) & (asked < STEPS.contact_mm)
        self._near = np.flatnonzero(short.any(axis=0))
        self._short, self._plain = short[:, self._near], hold & ~short

    def at(self, weights: Array, rows: Columns) -> tuple[Array, Array]:
        """Return misses, (n, values), and slopes, (n, values, 52), of frames `rows`; zero where nothing is held."""
        plain, asked = self._plain[rows], self._asked[rows]
        reached, slope = self._measurer.jacobian(weights, self._columns)
        miss, slope = np.where(plain, asked - reached, 0.0), slope * plain[:, :, None]
        if not len(self._near):
            return miss, slope
        vectors, along = self._measurer.vectors(weights, self._columns[self._near])  # (n, near, 3)
        length = np.linalg.norm(vectors, axis=2)
        wanted = np.maximum(asked[:, self._near], 0.0) / np.maximum(length, 1e-9)
        off = self._short[rows][:, :, None] * (wanted - 1.0)[:, :, None] * vectors
        along = along * np.repeat(self._short[rows], 3, axis=1)[:, :, None]
        return np.concatenate([miss, off.reshape(len(rows), -1)], axis=1), np.concatenate([slope, along], axis=1)


def _step(slope: Array, miss: Array, damping: Array, *, covariance: Array, at: tuple[Array, Array, Array]) -> Array:
    """Return the damped step, (frames, 52), that leaves weights at a limit where they would go beyond it.

    `at` are weights and the least and the most that they may be, (frames, 52) each.
    """
    weights, low, high = at
    free: Mask = np.ones(weights.shape, bool)
    step = _damped(slope, miss, covariance, damping)
    for _ in range(STEPS.releases):
        stuck: Mask = free & (((weights <= low) & (step < 0)) | ((weights >= high) & (step > 0)))
        rows = np.flatnonzero(stuck.any(axis=1))
        if not len(rows):
            break
        free &= ~stuck
        step[rows] = free[rows] * _damped(slope[rows] * free[rows, None, :], miss[rows], covariance, damping[rows])
    return step


def _damped(slope: Array, miss: Array, covariance: Array, damping: Array) -> Array:
    spread = slope @ covariance  # (frames, columns, 52)
    gram = spread @ slope.transpose(0, 2, 1) + damping[:, None, None] * np.eye(slope.shape[1])
    pull = np.linalg.solve(gram, miss[..., None])  # (frames, columns, 1)
    return np.asarray((spread * pull).sum(axis=1))
