"""Projection of weights onto control values: the smallest change, in the Euclidean norm, that reaches them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from engine.controls import Measurer
from engine.take import SHAPES, Array, Mask

_EYES = np.array([name.startswith("eye") and "Look" not in name for name in SHAPES])
_LOWER = np.array([name.startswith(("jaw", "mouth", "cheekPuff", "noseSneer")) for name in SHAPES])
FREE = {"lower": _LOWER, "eyelids": _EYES}  # by the area of the control


@dataclass(frozen=True)
class Tuning:
    """Settings of the Levenberg-Marquardt iteration; ranges tried were not recorded."""

    rounds: int = 24
    first_damping: float = 1e-2  # mm^2
    least_damping: float = 1e-4  # mm^2
    less: float = 0.2  # factor of the damping after a step that came nearer
    more: float = 8.0  # and after one that did not
    met_mm: float = 1e-3  # mm, distance at which a target is met


TUNING = Tuning()


def project(
    weights: Array,
    targets: Array,
    columns: npt.NDArray[np.int64],
    measurer: Measurer,
    *,
    free: Mask,
    rounds: int = TUNING.rounds,
) -> Array:
    """Project weights, (frames, 52), onto values `targets`, (frames, columns) in mm, of the controls `columns`.

    Levenberg-Marquardt steps ``J' (J J' + damping I)^-1 (t - c)`` frame by frame, taken only where they come nearer;
    close to a contact, where distances have no slope, Gauss-Newton alone would overshoot. Weights stay in 0..1 (or at
    the recorded value, where a take lies outside it); a weight at its limit that would go further is left out of the
    next step. Only weights in `free`, (52,) bool, move.
    """
    current = np.array(weights)
    low, high = np.minimum(weights, 0.0), np.maximum(weights, 1.0)
    damping = np.full(len(weights), TUNING.first_damping)
    missing = targets - measurer.measure(current)[:, columns]
    for _ in range(rounds):
        rows = np.flatnonzero(np.abs(missing).max(axis=1, initial=0.0) > TUNING.met_mm)
        if not len(rows):
            break
        slope = measurer.jacobian(current[rows])[:, columns] * free
        pull = np.einsum("fcs,fc->fs", slope, missing[rows])
        stuck = ((current[rows] <= low[rows]) & (pull < 0)) | ((current[rows] >= high[rows]) & (pull > 0))
        step = _step(np.where(stuck[:, None, :], 0.0, slope), missing[rows], damping[rows])
        tried = np.clip(current[rows] + step, low[rows], high[rows])
        left = targets[rows] - measurer.measure(tried)[:, columns]
        nearer = (left**2).sum(axis=1) < (missing[rows] ** 2).sum(axis=1)
        current[rows[nearer]], missing[rows[nearer]] = tried[nearer], left[nearer]
        factor = np.where(nearer, TUNING.less, TUNING.more)
        damping[rows] = np.maximum(damping[rows] * factor, TUNING.least_damping)
    return current


def _step(slope: Array, missing: Array, damping: Array) -> Array:
    """Return the damped step, (frames, 52), by slopes, (frames, controls, 52), towards (frames, controls) mm."""
    gram = slope @ slope.transpose(0, 2, 1) + damping[:, None, None] * np.eye(slope.shape[1])
    return np.asarray(np.einsum("fcs,fc->fs", slope, np.linalg.solve(gram, missing[..., None])[..., 0]))
