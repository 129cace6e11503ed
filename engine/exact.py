"""Landing on asked control values: the smallest change of weights that reaches them, as far as weights in range allow."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from engine.controls import Measurer
from engine.take import Array

ROUNDS = 24
DAMPING = 1e-3  # mm^2; keeps the step finite where a control hardly moves


def project(
    weights: Array,
    asked: Array,
    columns: npt.NDArray[np.int64],
    measurer: Measurer,
    *,
    free: npt.NDArray[np.bool_],
    rounds: int = ROUNDS,
) -> Array:
    """Return weights whose controls `columns` reach `asked`, (frames, columns) in mm, near `weights`, (frames, 52).

    Gauss-Newton on the measured Jacobian: each round takes the step of least norm towards the asked value and limits it
    to the range 0..1 (or to the recorded value, where a take lies outside it); a weight that has met its limit and
    would go further is left out of the next round. Only weights in `free`, (52,) bool, move.
    """
    current = np.array(weights)
    low, high = np.minimum(weights, 0.0), np.maximum(weights, 1.0)
    for _ in range(rounds):
        missing = asked - measurer.measure(current)[:, columns]
        if np.abs(missing).max(initial=0.0) < 1e-6:
            break
        slope = measurer.jacobian(current)[:, columns] * free
        pull = np.einsum("fcs,fc->fs", slope, missing)
        stuck = ((current <= low) & (pull < 0)) | ((current >= high) & (pull > 0))
        slope = np.where(stuck[:, None, :], 0.0, slope)
        gram = slope @ slope.transpose(0, 2, 1) + DAMPING * np.eye(len(columns))
        step = np.einsum("fcs,fc->fs", slope, np.linalg.solve(gram, missing[..., None])[..., 0])
        current = np.clip(current + step, low, high)
    return current
