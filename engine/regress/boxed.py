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


@dataclass(frozen=True, eq=False)
class Boxes:
    """Where each of some changes starts, and its bounds, (n, values) each."""

    start: Array
    low: Array
    high: Array

    def rows(self, chosen: npt.NDArray[np.int64] | Mask) -> Boxes:
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
    spread = (slopes.reshape(-1, slopes.shape[2]) @ covariance).reshape(slopes.shape)
    missing = goals - (slopes @ boxes.start[..., None])[..., 0]
    gram = spread @ slopes.transpose(0, 2, 1) + softness * np.eye(slopes.shape[1])
    found = np.empty_like(boxes.start)
    rows, fewest, patience = (
        np.arange(len(found)),
        np.full(len(found), slopes.shape[2] + 1),
        np.full(len(found), PATIENCE),
    )
    for _ in range(GUESSES):
        here, held = boxes.rows(rows), sides[rows]
        values, push = _held(here, held, spread[rows], (gram[rows], missing[rows]), covariance)
        found[rows] = np.clip(values, here.low, here.high)
        crossed = (values > here.high + EDGE).astype(float) - (values < here.low - EDGE)
        guess = np.where(
            held == 0, crossed, np.where(held * push < 0, held, 0.0)
        )  # a bound that would have to pull lets go
        wrong = guess != held
        count = wrong.sum(axis=1)
        better = count < fewest[rows]
        fewest[rows] = np.where(better, count, fewest[rows])
        patience[rows] = np.where(better, PATIENCE, patience[rows] - 1)
        last = wrong & (np.cumsum(wrong[:, ::-1], axis=1)[:, ::-1] == 1)
        sides[rows] = np.where(np.where(patience[rows, None] < 0, last, wrong), guess, held)
        if not count.any():
            break
        rows = rows[count > 0]
    return found


def _held(
    boxes: Boxes, sides: Array, spread: Array, equations: tuple[Array, Array], covariance: Array
) -> tuple[Array, Array]:
    """Return values, (n, values), when bounds hold those at `sides`, and the push of the bounds on them."""
    gram, missing = equations
    held, goals = sides != 0, gram.shape[1]
    most = int(held.sum(axis=1).max(initial=0))
    if not most:
        pull = np.linalg.solve(gram, missing[..., None])
        return boxes.start + (pull.transpose(0, 2, 1) @ spread)[:, 0], np.zeros_like(sides)
    rows = np.arange(len(sides))[:, None]
    at = np.argsort(~held, axis=1, kind="stable")[:, :most]  # those that are held first
    real = held[rows, at]
    system = np.empty((len(sides), goals + most, goals + most))
    system[:, :goals, :goals] = gram
    across = spread.transpose(0, 2, 1)[rows, at] * real[:, :, None]
    system[:, goals:, :goals], system[:, :goals, goals:] = across, across.transpose(0, 2, 1)
    system[:, goals:, goals:] = covariance[at[:, :, None], at[:, None, :]] * (real[:, :, None] & real[:, None, :])
    system.reshape(len(sides), -1)[:, goals * (goals + most + 1) :: goals + most + 1] += ~real
    gap = (np.where(sides > 0, boxes.high, boxes.low) - boxes.start)[rows, at]
    pull = np.linalg.solve(system, np.concatenate([missing, gap * real], axis=1)[..., None])[..., 0]
    push = np.zeros_like(boxes.start)
    push[rows, at] = pull[:, goals:] * real
    change = (pull[:, None, :goals] @ spread)[:, 0] + push @ covariance
    return boxes.start + change, push
