"""The smallest change, as some covariance measures it, that reaches linear goals within a box: many small ones at once.

Each is ``min 1/2 |x - start|^2 in the metric S^-1 + |J x - goal|^2 / (2 d)`` over ``low <= x <= high``. Its solution goes
on without a jump as start, goal and slopes do, and a goal that is further away is never met less. Values that their
bounds hold are found by the primal-dual active set method (Hintermüller, Ito and Kunisch 2003): a guess at them leaves a
linear system, whose solution makes the next guess.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from engine.take import Array, Mask

GUESSES = 12  # at most; few frames need more than four
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
    rows = np.arange(len(found))
    for _ in range(GUESSES):
        here, held = boxes.rows(rows), sides[rows]
        values, push = _held(here, held, spread[rows], missing[rows], gram[rows], covariance)
        found[rows] = np.clip(values, here.low, here.high)
        stay = np.where(held * push < 0, held, 0.0)  # a bound that would have to pull lets go
        crossed = np.where(values > here.high + EDGE, 1.0, np.where(values < here.low - EDGE, -1.0, 0.0))
        sides[rows] = np.where(held == 0, crossed, stay)
        rows = rows[(sides[rows] != held).any(axis=1)]
        if not len(rows):
            break
    return found


def _held(
    boxes: Boxes, sides: Array, spread: Array, missing: Array, gram: Array, covariance: Array
) -> tuple[Array, Array]:
    """Return values, (n, values), when bounds hold those at `sides`, and the push of the bounds on them."""
    held = sides != 0
    goals, most = gram.shape[1], int(held.sum(axis=1).max(initial=0))
    if not most:
        pull = np.linalg.solve(gram, missing[..., None])
        return boxes.start + (pull.transpose(0, 2, 1) @ spread)[:, 0], np.zeros_like(sides)
    at = np.argsort(~held, axis=1, kind="stable")[:, :most]  # those that are held first
    real = np.take_along_axis(held, at, axis=1)
    system = np.zeros((len(sides), goals + most, goals + most))
    system[:, :goals, :goals] = gram
    across = np.take_along_axis(spread, at[:, None], axis=2) * real[:, None]
    system[:, :goals, goals:], system[:, goals:, :goals] = across, across.transpose(0, 2, 1)
    among = covariance[at[:, :, None], at[:, None, :]] * (real[:, :, None] & real[:, None, :])
    system[:, goals:, goals:] = among
    system[:, np.arange(goals, goals + most), np.arange(goals, goals + most)] += ~real
    gap = np.where(sides > 0, boxes.high, boxes.low) - boxes.start
    wanted = np.concatenate([missing, np.take_along_axis(gap, at, axis=1) * real], axis=1)
    pull = np.linalg.solve(system, wanted[..., None])[..., 0]
    push = np.zeros_like(boxes.start)
    np.put_along_axis(push, at, pull[:, goals:] * real, axis=1)
    change = (pull[:, None, :goals] @ spread)[:, 0] + push @ covariance
    return boxes.start + change, push
