"""The smallest change, as some covariance measures it, that reaches linear goals within a box: many small ones at once.

Each is ``min 1/2 |x - start|^2 in the metric S^-1 + |J x - goal|^2 / (2 d)`` over ``low <= x <= high``. Its solution goes
on without a jump as start, goal and slopes do, and a goal that is further away is never met less. Values that their
bounds hold are found by the primal-dual active set method (Hintermüller, Ito and Kunisch 2003): a guess at them leaves a
linear system, whose solution makes the next guess. Where all guesses at once get no better, one value at a time is guessed
anew (block principal pivoting, Júdice and Pires 1994), which ends.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from engine.take import Array, Mask

GUESSES = 80  # at most; few need more than four
PATIENCE = 3  # guesses that may be no better, before one value at a time is guessed anew
EDGE = 1e-9  # of a value, by which it is beyond its bound

Indices = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Boxes:
    """Where each of some changes starts, and its bounds, (n, values) each."""

    start: Array
    low: Array
    high: Array

    def rows(self, chosen: Indices | Mask) -> Boxes:
        """Return some of them."""
        return Boxes(self.start[chosen], self.low[chosen], self.high[chosen])


def nearest(boxes: Boxes, slopes: Array, goals: Array, *, covariance: Array, softness: float, sides: Array) -> Array:
    """Return values, (n, values), within their boxes, nearest to their starts, whose ``slopes @ values`` are the goals.

    Parameters
    ----------
    slopes, goals : (n, goals, values) and (n, goals)
    covariance : S, (values, values)
    softness : d, in the goals' unit squared: what is missing may be missed where it would cost too much
    sides : (n, values), -1 where a value is guessed to be held by its lower bound, 1 by its upper; the last guess comes
        back in it
    """
    found, padded = np.empty_like(boxes.start), _padded(covariance)
    rows, patience = np.arange(len(found)), _Patience(len(found))
    here, equations = boxes, _equations(boxes, slopes, goals, covariance, softness)
    for _ in range(GUESSES):
        held = sides[rows]
        values, push = _held(here, held, equations, padded)
        found[rows] = values
        crossed = np.subtract(values > here.high + EDGE, values < here.low - EDGE, dtype=float)
        # a bound that would have to pull lets go
        guess = np.where(held == 0, crossed, held * (held * push < 0))
        wrong = guess != held
        count = wrong.sum(axis=1)
        sides[rows] = np.where(patience.which(rows, wrong, count), guess, held)
        left = count > 0
        if not left.any():
            break
        if not left.all():
            rows, here = rows[left], here.rows(left)
            equations = equations[0][left], equations[1][left], equations[2][left]
    return np.clip(found, boxes.low, boxes.high)


def unheld(boxes: Boxes, slopes: Array, goals: Array, *, covariance: Array, softness: float) -> Array:
    """Return what `nearest` would where no bound is met, clipped: without a jump too, but it falls short at bounds."""
    spread, gram, missing = _equations(boxes, slopes, goals, covariance, softness)
    return np.clip(_free(boxes, spread, gram, missing), boxes.low, boxes.high)


def _equations(
    boxes: Boxes, slopes: Array, goals: Array, covariance: Array, softness: float
) -> tuple[Array, Array, Array]:
    """Return the slopes times the covariance, that times the slopes again, and what is missing at the starts."""
    spread = (slopes.reshape(-1, slopes.shape[2]) @ covariance).reshape(slopes.shape)
    missing = goals - (slopes @ boxes.start[..., None])[..., 0]
    return spread, spread @ slopes.transpose(0, 2, 1) + softness * np.eye(slopes.shape[1]), missing


def _free(boxes: Boxes, spread: Array, gram: Array, missing: Array) -> Array:
    pull = np.linalg.solve(gram, missing[..., None])
    return np.asarray(boxes.start + (pull.transpose(0, 2, 1) @ spread)[:, 0])


def _padded(covariance: Array) -> Array:
    padded = np.zeros((len(covariance) + 1, len(covariance) + 1))
    padded[:-1, :-1] = covariance
    return padded


class _Patience:
    """Tells which wrong guesses are mended: all at once, or the last alone where that got no better for some time."""

    def __init__(self, count: int) -> None:
        self._fewest, self._left = np.full(count, np.iinfo(np.int64).max), np.full(count, PATIENCE)

    def which(self, rows: Indices, wrong: Mask, count: Indices) -> Mask:
        """Return which of the wrong ones, (rows, values), of which there are `count` a row, are mended now."""
        better = count < self._fewest[rows]
        self._fewest[rows] = np.minimum(count, self._fewest[rows])
        self._left[rows] = left = np.where(better, PATIENCE, self._left[rows] - 1)
        if (left >= 0).all():
            return wrong
        last = wrong & (np.cumsum(wrong[:, ::-1], axis=1)[:, ::-1] == 1)
        return np.where(left[:, None] < 0, last, wrong)


def _held(boxes: Boxes, sides: Array, equations: tuple[Array, Array, Array], padded: Array) -> tuple[Array, Array]:
    """Return values, (n, values), when bounds hold those at `sides`, and the push of the bounds on them.

    `equations` are the slopes times the covariance, that times the slopes again, and what is missing; `padded` is the
    covariance with a row and a column of zeros, which stand where a row holds fewer than another.
    """
    spread, gram, missing = equations
    held, (count, goals, shapes) = sides != 0, spread.shape
    most = int(held.sum(axis=1).max(initial=0))
    if not most:
        return _free(boxes, *equations), np.zeros_like(sides)
    rows = np.arange(count)[:, None]
    at = np.argsort(~held, axis=1, kind="stable")[:, :most]  # those that are held first
    real = held[rows, at]
    gap = np.where(sides > 0, boxes.high, boxes.low)[rows, at] - boxes.start[rows, at]
    wanted = np.concatenate([missing, gap * real], axis=1)[..., None]
    system = np.empty((count, goals + most, goals + most))
    system[:, :goals, :goals] = gram
    across = spread.transpose(0, 2, 1)[rows, at] * real[:, :, None]
    system[:, goals:, :goals], system[:, :goals, goals:] = across, across.transpose(0, 2, 1)
    to = np.where(real, at, shapes)
    system[:, goals:, goals:] = padded.take(to[:, :, None] * (shapes + 1) + to[:, None, :])
    system.reshape(count, -1)[:, goals * (goals + most + 1) :: goals + most + 1] += ~real
    pull = np.linalg.solve(system, wanted)[..., 0]
    push = np.zeros((count, shapes + 1))
    push[rows, to] = pull[:, goals:]
    push = push[:, :shapes]
    return boxes.start + (pull[:, None, :goals] @ spread)[:, 0] + push @ padded[:shapes, :shapes], push
