"""The smallest change of a face that reaches asked control values, measured as recorded faces vary."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from engine.controls import ALL_INDEX
from engine.extended import Columns, FaceMeasurer, Gauges
from engine.regress.boxed import Boxes, nearest, unheld
from engine.take import Array, Mask

_LIPS = ALL_INDEX["lips_vertical"]  # lids have too few shapes to meet point on point, and would go wide while shut


@dataclass(frozen=True)
class Steps:
    """Tuned constants of the search for a face.

    Attributes
    ----------
    rounds : at most
    soft_mm2 : what is missing may stay so where every further millimetre squared would cost more than one over this, in
        squared deviations of recorded faces [1e-6..1e-2]
    shorter, longer : factor of the share of a step that is taken, after one that did not come nearer and after one that did
    same : share of the cost, by which a step may be dearer than the last
    contact_mm : asked distances shorter than this are met point on point [0.5..3]
    met_mm : a miss that is none
    """

    rounds: int = 14
    soft_mm2: float = 1e-4
    shorter: float = 0.3
    longer: float = 2.0
    same: float = 1e-6
    contact_mm: float = 1.5
    met_mm: float = 1e-3


STEPS = Steps()


def project(
    weights: Array,
    asked: Array,
    columns: Columns,
    *,
    hold: Mask,
    covariance: Array,
    measurer: FaceMeasurer,
    roughly: bool = False,
) -> Array:
    """Return weights, (frames, 52), near `weights` whose controls reach `asked`, (frames, columns), where `hold` says so.

    Minimises ``|w - weights|^2 + |C(w) - asked|^2 / d``, the first in the metric of the inverse covariance, over weights
    in 0..1, or down or up to the recorded value where a take lies outside; frame by frame. Gauss and Newton's steps: each
    solves it with the slopes at the weights so far (`boxed.nearest`), and is cut short until it comes nearer. So the
    face goes on without a jump as what is asked does, and asking more never gives less.

    Parameters
    ----------
    covariance : (52, 52), zero in the rows and columns of weights that shall not move
    roughly : whether the first step will do, cut off at the bounds
    """
    made, shapes = np.array(weights), np.flatnonzero(covariance.any(axis=0))
    search = _Search(weights[:, shapes], covariance[np.ix_(shapes, shapes)])
    goal = _Goal(measurer.gauges(columns, shapes), columns, asked, hold)
    active = np.flatnonzero(hold.any(axis=1))
    vectors, miss = goal.missing(made[active], active)
    far = np.abs(miss).max(axis=1, initial=0.0) > STEPS.met_mm
    if roughly:
        slope = goal.slopes(vectors, made[active], active)
        made[np.ix_(active, shapes)] = search.rough(active, slope, miss)
        return made
    for _ in range(STEPS.rounds):
        active, vectors, miss = active[far], vectors[far], miss[far]
        if not len(active):
            break
        slope, here = goal.slopes(vectors, made[active], active), made[active]
        step = search.step(active, slope, miss, at=here[:, shapes])
        here[:, shapes] += step
        tried, left = goal.missing(here, active)
        nearer = search.judge(active, here[:, shapes], miss, left)
        made[active[nearer]] = here[nearer]
        bent = np.abs(left - miss + (slope @ step[..., None])[..., 0]).max(axis=1)  # what no slope told of
        far = ~nearer | (bent > STEPS.met_mm)
        vectors = np.where(nearer[:, None, None], tried, vectors)
        miss = np.where(nearer[:, None], left, miss)
    return made


class _Search:
    """Where each frame's search for its weights stands.

    Parameters
    ----------
    start : (frames, shapes), near which weights are looked for
    covariance : (shapes, shapes)
    """

    def __init__(self, start: Array, covariance: Array) -> None:
        self._boxes = Boxes(start, np.minimum(start, 0.0), np.maximum(start, 1.0))
        self._covariance, self._precision = covariance, _inverse(covariance.tobytes())
        self._sides = np.zeros_like(start)
        self._share = np.ones(len(start))
        self._cost = np.zeros(len(start))

    def step(self, rows: Columns, slope: Array, miss: Array, *, at: Array) -> Array:
        """Return the step, (rows, shapes), from weights `at`, by their slopes and misses, as long as it is trusted."""
        sides = self._sides[rows]
        goals = miss + (slope @ at[..., None])[..., 0]
        found = nearest(
            self._boxes.rows(rows), slope, goals, covariance=self._covariance, softness=STEPS.soft_mm2, sides=sides
        )
        self._sides[rows] = sides
        return np.asarray(self._share[rows, None] * (found - at))

    def rough(self, rows: Columns, slope: Array, miss: Array) -> Array:
        """Return weights, (rows, shapes), that the slopes at the start send there, whatever bounds stop."""
        boxes = self._boxes.rows(rows)
        goals = miss + (slope @ boxes.start[..., None])[..., 0]
        return unheld(boxes, slope, goals, covariance=self._covariance, softness=STEPS.soft_mm2)

    def judge(self, rows: Columns, tried: Array, miss: Array, left: Array) -> Mask:
        """Return which frames came nearer with the weights they tried; the others' next steps are shorter."""
        away = tried - self._boxes.start[rows]
        moved = ((away @ self._precision) * away).sum(axis=1)
        cost = moved + (left**2).sum(axis=1) / STEPS.soft_mm2
        before = np.where(self._cost[rows] > 0, self._cost[rows], (miss**2).sum(axis=1) / STEPS.soft_mm2)
        nearer = np.asarray(cost <= before * (1 + STEPS.same))
        self._cost[rows] = np.where(nearer, cost, before)
        self._share[rows] = np.where(
            nearer, np.minimum(1.0, self._share[rows] * STEPS.longer), self._share[rows] * STEPS.shorter
        )
        return nearer


@lru_cache(maxsize=16)
def _inverse(covariance: bytes) -> Array:
    """Return the inverse of a covariance, which stays the same from drag to drag."""
    values = np.frombuffer(covariance)
    return np.asarray(np.linalg.inv(values.reshape(math.isqrt(len(values)), -1)), np.float64)


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
