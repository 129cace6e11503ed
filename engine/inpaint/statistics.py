"""Joint statistics of weights and controls, and the linear regression of weights on controls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engine.controls import bundled_measurer
from engine.take import Array


@dataclass(frozen=True)
class Tuning:
    """Regularisation of the statistics and of the regression; the range tried on validation takes in brackets."""

    control_noise_mm: float = 0.5  # mm [0.1 .. 2]; standard deviation of the error that a target curve is allowed
    least_scale: float = 0.02  # weight; smallest standard deviation, so that a shape at rest divides by no zero


TUNING = Tuning()


@dataclass(frozen=True, eq=False)
class Statistics:
    """First and second moments of weights and controls over the training takes.

    Attributes
    ----------
    mean, scale : (52,) mean and standard deviation of the weights
    rest : (8,) mm, mean of the controls
    spread : (8, 8) mm^2, covariance of the controls
    cross : (8, 52) mm, covariance of controls with weights
    """

    mean: Array
    scale: Array
    rest: Array
    spread: Array
    cross: Array


def statistics_of(weights: Array) -> Statistics:
    """Return the statistics of many poses, (poses, 52)."""
    controls = bundled_measurer().measure(weights)
    mean, rest = weights.mean(axis=0), controls.mean(axis=0)
    off, away = weights - mean, controls - rest
    return Statistics(
        mean,
        np.maximum(weights.std(axis=0), TUNING.least_scale),
        rest,
        away.T @ away / len(away),
        away.T @ off / len(away),
    )


def regression(columns: np.ndarray, statistics: Statistics) -> Array:
    """Return the ridge regression of weights on some controls, (controls, 52) per mm: ``(C + noise^2 I)^-1 X``.

    C is their covariance, X their covariance with the weights; `columns` are indices of controls.
    """
    noise = TUNING.control_noise_mm**2 * np.eye(len(columns))
    return np.asarray(np.linalg.solve(statistics.spread[np.ix_(columns, columns)] + noise, statistics.cross[columns]))


def regress_controls(base: Array, blend: Array, controls: Array, statistics: Statistics) -> Array:
    """Move poses towards control targets by linear regression on the controls that have a target.

    ``w + blend (c* - c(w)) G`` with G of `regression`, clipped to 0..1.

    Parameters
    ----------
    base : (frames, 52) weights
    blend : (frames, 52) in 0..1, the share of the step that each weight takes
    controls : (frames, 8) mm, targets; NaN where there is none
    """
    targeted = np.isfinite(controls)
    if not targeted.any():
        return base
    missing = np.where(targeted, controls - bundled_measurer().measure(base), 0.0)
    moved = np.array(base)
    for pattern in np.unique(targeted, axis=0):
        if pattern.any():
            rows, columns = (targeted == pattern).all(axis=1), np.flatnonzero(pattern)
            moved[rows] += blend[rows] * (missing[np.ix_(rows, columns)] @ regression(columns, statistics))
            moved[rows] = np.where(blend[rows] > 0, np.clip(moved[rows], 0.0, 1.0), base[rows])
    return moved
