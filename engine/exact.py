"""The smallest change of weights, each counting alike, that reaches asked control values."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from engine.controls import Measurer
from engine.take import SHAPES, Array, Mask

_EYES = np.array([name.startswith("eye") and "Look" not in name for name in SHAPES])
_LOWER = np.array([name.startswith(("jaw", "mouth", "cheekPuff", "noseSneer")) for name in SHAPES])
FREE = {"lower": _LOWER, "eyelids": _EYES}  # by the area of the control

ROUNDS = 24
FIRST_DAMPING, LEAST_DAMPING = 1e-2, 1e-4  # mm^2
LESS, MORE = 0.2, 8.0  # what becomes of the damping after a round that came nearer, and after one that did not
MET_MM = 1e-3


def project(
    weights: Array,
    asked: Array,
    columns: npt.NDArray[np.int64],
    measurer: Measurer,
    *,
    free: Mask,
    rounds: int = ROUNDS,
) -> Array:
    """Return weights whose controls `columns` reach `asked`, (frames, columns) in mm, near `weights`, (frames, 52).

    Levenberg and Marquardt's steps on the measured Jacobian, frame by frame: each is the smallest that goes most of the
    way to the asked value, and is taken only where it comes nearer; close to a contact, where distances have no slope,
    Gauss-Newton alone would throw the lids past each other. Weights stay in 0..1 (or at the recorded value, where a
    take lies outside it); one that has met its limit and would go further is left out of the next round. Only weights
    in `free`, (52,) bool, move.
    """
    current = np.array(weights)
    low, high = np.minimum(weights, 0.0), np.maximum(weights, 1.0)
    damping = np.full(len(weights), FIRST_DAMPING)
    missing = asked - measurer.measure(current)[:, columns]
    for _ in range(rounds):
        rows = np.flatnonzero(np.abs(missing).max(axis=1, initial=0.0) > MET_MM)
        if not len(rows):
            break
        slope = measurer.jacobian(current[rows])[:, columns] * free
        pull = np.einsum("fcs,fc->fs", slope, missing[rows])
        stuck = ((current[rows] <= low[rows]) & (pull < 0)) | ((current[rows] >= high[rows]) & (pull > 0))
        step = _step(np.where(stuck[:, None, :], 0.0, slope), missing[rows], damping[rows])
        tried = np.clip(current[rows] + step, low[rows], high[rows])
        left = asked[rows] - measurer.measure(tried)[:, columns]
        nearer = (left**2).sum(axis=1) < (missing[rows] ** 2).sum(axis=1)
        current[rows[nearer]], missing[rows[nearer]] = tried[nearer], left[nearer]
        damping[rows] = np.maximum(damping[rows] * np.where(nearer, LESS, MORE), LEAST_DAMPING)
    return current


def _step(slope: Array, missing: Array, damping: Array) -> Array:
    """Return the damped step, (frames, 52), by slopes, (frames, controls, 52), towards (frames, controls) mm."""
    gram = slope @ slope.transpose(0, 2, 1) + damping[:, None, None] * np.eye(slope.shape[1])
    return np.asarray(np.einsum("fcs,fc->fs", slope, np.linalg.solve(gram, missing[..., None])[..., 0]))
