"""Figures of merit that several tables share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from engine.take import Array


@dataclass(frozen=True)
class Closures:
    """How often closures survive, and how often they are invented, at each threshold.

    Attributes
    ----------
    thresholds : (n,) mm; a mouth or an eye is closed where its distance is below
    tpr : (n,) share of the truly closed frames that are closed; NaN where the truth never closes
    fpr : (n,) frames falsely closed per truly closed frame (BSBS19 section 5.1); NaN likewise
    """

    thresholds: tuple[float, ...]
    tpr: Array
    fpr: Array


def mse(made: Array, truth: Array) -> float:
    """Return the mean squared error of two arrays of one shape."""
    return float(((made - truth) ** 2).mean())


def closures(made: Array, truth: Array, thresholds: Sequence[float]) -> Closures:
    """Compare closures of distances, (frames,) or (frames, n) in mm; all columns are counted together."""
    tpr, fpr = np.full(len(thresholds), np.nan), np.full(len(thresholds), np.nan)
    for index, threshold in enumerate(thresholds):
        closed, wanted = made < threshold, truth < threshold
        if wanted.any():
            tpr[index] = (closed & wanted).sum() / wanted.sum()
            fpr[index] = (closed & ~wanted).sum() / wanted.sum()
    return Closures(tuple(thresholds), tpr, fpr)


def tracking_error(asked: Array, reached: Array) -> Array:
    """Return the root mean square, (n,), by which reached curves, (frames, n), miss asked ones."""
    return np.asarray(np.sqrt(((reached - asked) ** 2).mean(axis=0)))


def velocity_error(made: Array, truth: Array, fps: float) -> float:
    """Return the mean absolute difference of velocities of curves, (frames, n), in units per second."""
    return float(np.abs(np.diff(made, axis=0) - np.diff(truth, axis=0)).mean() * fps)
