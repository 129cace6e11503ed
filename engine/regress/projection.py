"""The smallest change of a face that reaches asked control values, measured as recorded faces vary."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engine.controls import ALL_INDEX
from engine.extended import Columns, FaceMeasurer, Gauges
from engine.take import Array, Mask

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
    current, shapes = np.array(weights), np.flatnonzero(covariance.any(axis=0))
    covariance = covariance[np.ix_(shapes, shapes)]
    goal = _Goal(measurer.gauges(columns, shapes), columns, asked, hold)
    damping = np.full(len(weights), STEPS.first)
    active = np.flatnonzero(hold.any(axis=1))
    low, high = (
        bound(weights[np.ix_(active, shapes)], limit) for bound, limit in ((np.minimum, 0.0), (np.maximum, 1.0))
    )
    vectors, miss = goal.missing(current[active], active)
    for _ in range(STEPS.rounds):
        far = np.abs(miss).max(axis=1, initial=0.0) > STEPS.met_mm
        if not far.any():
            break
        if not far.all():
            active, vectors, miss, low, high = active[far], vectors[far], miss[far], low[far], high[far]
        here = current[active]
        slope = goal.slopes(vectors, here, active)
        at = here[:, shapes]
        step = _step(slope, miss, damping[active], covariance=covariance, at=(at, low, high))
        here[:, shapes] = np.clip(at + step, low, high)
        tried, left = goal.missing(here, active)
        nearer = (left**2).sum(axis=1) < (miss**2).sum(axis=1)
        current[active[nearer]] = here[nearer]
        vectors = np.where(nearer[:, None, None], tried, vectors)
        miss = np.where(nearer[:, None], left, miss)
        damping[active] = np.maximum(damping[active] * np.where(nearer, STEPS.less, STEPS.more), STEPS.least)
    return current


class _Goal:
    """What is still missing, and by which slopes it is to be had.

    Close to nothing a distance has no slope but along itself, and points would circle each other: where one as short as
    `STEPS.contact_mm` is asked for, its three coordinates are, along the direction it has.
    """

    def __init__(self, gauges: Gauges, columns: Columns, asked: Array, hold: Mask) -> None:
        self._gauges, self._asked = gauges, asked
        short: Mask = hold & (columns == _LIPS) & (asked < STEPS.contact_mm)
        self._near = np.flatnonzero(short.any(axis=0)).tolist()  # the lips, if they are among the columns
        self._short, self._plain = short, hold & ~short
        self._all = bool(self._plain.all())

    def missing(self, weights: Array, rows: Columns) -> tuple[Array, Array]:
        """Return the vectors at weights, and misses, (n, values), of frames `rows`; zero where nothing is held."""
        vectors = self._gauges.vectors(weights)
        miss = self._asked[rows] - self._gauges.read(vectors)
        if not self._all:
            miss = np.where(self._plain[rows], miss, 0.0)
        for column in self._near:
            vector = self._gauges.vector(vectors, column)
            length = np.maximum(np.sqrt((vector**2).sum(axis=1)), 1e-9)
            longer = np.maximum(self._asked[rows, column], 0.0) / length - 1.0
            miss = np.concatenate([miss, (self._short[rows, column] * longer)[:, None] * vector], axis=1)
        return vectors, miss

    def slopes(self, vectors: Array, weights: Array, rows: Columns) -> Array:
        """Return the slopes, (n, values, shapes), at these vectors and weights; zero where nothing is held."""
        joined = self._gauges.joined(weights)
        slope = self._gauges.slopes(vectors, joined)
        if not self._all:
            slope = slope * self._plain[rows][:, :, None]
        for column in self._near:
            along = self._gauges.coordinate_slopes(column, joined) * self._short[rows, column, None, None]
            slope = np.concatenate([slope, along], axis=1)
        return slope


def _step(slope: Array, miss: Array, damping: Array, *, covariance: Array, at: tuple[Array, Array, Array]) -> Array:
    """Return the damped step, (frames, shapes), that leaves weights at a limit where they would go beyond it.

    `at` are weights and the least and the most that they may be, (frames, shapes) each.
    """
    weights, low, high = at
    at_low, at_high = weights <= low, weights >= high
    step = _damped(slope, miss, covariance, damping)
    free: Mask = np.ones(weights.shape, bool)
    rows = np.arange(len(weights))
    for _ in range(STEPS.releases):
        stuck: Mask = free[rows] & ((at_low[rows] & (step[rows] < 0)) | (at_high[rows] & (step[rows] > 0)))
        rows = rows[stuck.any(axis=1)]
        if not len(rows):
            break
        free[rows] &= ~stuck[stuck.any(axis=1)]
        step[rows] = free[rows] * _damped(slope[rows] * free[rows, None, :], miss[rows], covariance, damping[rows])
    return step


def _damped(slope: Array, miss: Array, covariance: Array, damping: Array) -> Array:
    _, values, shapes = slope.shape
    spread = (slope.reshape(-1, shapes) @ covariance).reshape(slope.shape)  # (frames, values, shapes)
    if values == 1:
        gram = (spread[:, 0] * slope[:, 0]).sum(axis=1) + damping
        return np.asarray(spread[:, 0] * (miss[:, 0] / gram)[:, None])
    gram = spread @ slope.transpose(0, 2, 1) + damping[:, None, None] * np.eye(values)
    pull = np.linalg.solve(gram, miss[..., None])  # (frames, values, 1)
    return np.asarray((pull.transpose(0, 2, 1) @ spread)[:, 0])
