"""The learning methods without memory that BSS20b compares with (section 4.4): a dense network and boosted trees.

Both see the input's derivatives at this frame and the one before, and its weights one frame ago; both estimate the
derivatives of the truth at this frame, which are summed up leakily, ``X^(k) = a (dt X^(k+1) + X^(k) before) + (1 - a)
estimate^(k)``, with the input itself as the estimate of order 0.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import torch
from torch import Tensor, nn

from engine.lab.performer.degrade import Tracked
from engine.take import SHAPES, Array

_SHAPES = len(SHAPES)
_UNIT = (1.0, 0.5, 0.02)  # weights, per second, per second squared: what each order is divided by
Estimate = Callable[[Array], Array]  # (frames, features) -> (frames, orders * 52), in units of `_UNIT`


def derivatives(weights: Array, times_s: Array, orders: int) -> list[Array]:
    """Return derivatives of orders 1..K, backward so that no frame needs the next one, each (frames, 52)."""
    steps = np.diff(times_s, prepend=2 * times_s[0] - times_s[1])[:, None]
    result = [weights]
    for _ in range(orders):
        result.append(np.diff(result[-1], axis=0, prepend=result[-1][:1]) / steps)
    return result[1:]


def features(weights: Array, times_s: Array, orders: int) -> Array:
    """Return (frames, (2 K + 1) * 52): derivatives at this frame and the last, and the weights at the last."""
    parts = [weights]
    for order, slope in enumerate(derivatives(weights, times_s, orders), start=1):
        scaled = np.arcsinh(slope * _UNIT[order])
        parts += [scaled, _before(scaled)]
    return np.concatenate([_before(parts[0]), *parts[1:]], axis=1)


def targets(weights: Array, times_s: Array, orders: int) -> Array:
    """Return (frames, K * 52): the derivatives to estimate, in units of `_UNIT`."""
    slopes = derivatives(weights, times_s, orders)
    return np.concatenate([slope * _UNIT[order] for order, slope in enumerate(slopes, start=1)], axis=1)


def _before(curves: Array) -> Array:
    return np.concatenate([curves[:1], curves[:-1]])


@dataclass(frozen=True)
class Rival:
    """A memoryless method as a filter.

    Attributes
    ----------
    estimate : features to derivatives
    orders : K
    leak : the share a of the running sum
    """

    estimate: Estimate
    orders: int
    leak: float

    def __call__(self, tracked: Tracked, times_s: Array) -> Array:
        """Clean a recorded performance; (frames, 52)."""
        flat = self.estimate(features(tracked.weights, times_s, self.orders))
        return self.summed(flat, tracked.weights, times_s)

    def summed(self, flat: Array, weights: Array, times_s: Array) -> Array:
        """Return the weights that leaky sums of estimated derivatives, (frames, K * 52), give."""
        estimates = [weights]
        for order in range(1, self.orders + 1):
            estimates.append(flat[:, (order - 1) * _SHAPES : order * _SHAPES] / _UNIT[order])
        upper = estimates[-1]
        for order in range(self.orders - 1, -1, -1):
            upper = _leaky(upper, estimates[order], times_s, self.leak)
        return np.clip(upper, 0.0, 1.0)


def _leaky(slope: Array, estimate: Array, times_s: Array, leak: float) -> Array:
    result = estimate.copy()
    for index, step in enumerate(np.diff(times_s), start=1):
        result[index] = leak * (step * slope[index] + result[index - 1]) + (1 - leak) * estimate[index]
    return result


class FullyConnected(nn.Module):
    """Two dense layers of 256 and an output: (frames, features) -> (frames, K * 52)."""

    def __init__(self, orders: int, hidden: int = 256) -> None:
        super().__init__()
        self.layers = nn.Sequential(
            nn.Linear((2 * orders + 1) * _SHAPES, hidden),
            nn.ELU(),
            nn.Linear(hidden, hidden),
            nn.ELU(),
            nn.Linear(hidden, orders * _SHAPES),
        )

    def forward(self, seen: Tensor) -> Tensor:
        """Estimate derivatives."""
        result: Tensor = self.layers(seen)
        return result

    def estimate(self, seen: Array) -> Array:
        """Estimate derivatives of numpy features."""
        with torch.inference_mode():
            result: Array = self(torch.tensor(seen, dtype=torch.float32)).numpy().astype(np.float64)
        return result


@dataclass(frozen=True, eq=False)
class Trees:
    """Boosted regression trees of all outputs as plain arrays, so that they can be stored and read without pickles.

    Attributes
    ----------
    roots : (outputs, trees) int32, index of each tree's first node
    feature, threshold, left, right, value : (nodes,); a leaf has feature -1
    base : (outputs,) what the trees add to
    """

    roots: npt.NDArray[np.int32]
    feature: npt.NDArray[np.int32]
    threshold: npt.NDArray[np.float32]
    left: npt.NDArray[np.int32]
    right: npt.NDArray[np.int32]
    value: npt.NDArray[np.float32]
    base: npt.NDArray[np.float32]

    def estimate(self, seen: Array) -> Array:
        """Estimate derivatives: (frames, features) -> (frames, outputs)."""
        seen = seen.astype(np.float32)
        rows = np.arange(len(seen))
        result = np.tile(self.base.astype(np.float64), (len(seen), 1))
        for output, roots in enumerate(self.roots):
            for root in roots:
                node = np.full(len(seen), root)
                while (inner := self.feature[node] >= 0).any():
                    goes_left = seen[rows, np.maximum(self.feature[node], 0)] <= self.threshold[node]
                    node = np.where(inner, np.where(goes_left, self.left[node], self.right[node]), node)
                result[:, output] += self.value[node]
        return result
