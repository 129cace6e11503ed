"""Landing on asked control values: the smallest change of weights that reaches them, and why it falls short."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from engine.controls import CONTROLS, Measurer
from engine.take import SHAPES, Array, Mask

_EYES = np.array([name.startswith("eye") and "Look" not in name for name in SHAPES])
_LOWER = np.array([name.startswith(("jaw", "mouth", "cheekPuff", "noseSneer")) for name in SHAPES])
FREE = {"lower": _LOWER, "eyelids": _EYES}  # by the area of the control

ROUNDS = 24
FIRST_DAMPING, LEAST_DAMPING = 1e-2, 1e-4  # mm^2
LESS, MORE = 0.2, 8.0  # what becomes of the damping after a round that came nearer, and after one that did not
MET_MM = 1e-3
SHORT_MM = 1.0  # misses that are told of
LEVER_MM = 0.75  # a shape at its limit is why, when its full range would move the control by at least this
NAMED = 2  # limits at most that a sentence lists


@dataclass(frozen=True)
class Shortfall:
    """Where a control misses most what was asked of it.

    Attributes
    ----------
    control : its column
    row : which of the frames
    asked, reached : mm
    why : what stands in the way, as the screen says it
    """

    control: int
    row: int
    asked: float
    reached: float
    why: str

    def __str__(self) -> str:
        return f"{CONTROLS[self.control].title} {self.reached:.1f} mm of {self.asked:.1f} asked: {self.why}"


def shortfalls(weights: Array, asked: Array, measurer: Measurer, *, exact_curve: bool) -> list[Shortfall]:
    """Return each control that misses by more than `SHORT_MM`, at its worst frame.

    `weights` are (frames, 52), `asked` (frames, controls) in mm with NaN where nothing is asked.
    """
    missing = np.nan_to_num(asked - measurer.measure(weights))
    found = []
    for column in np.flatnonzero(np.abs(missing).max(axis=0, initial=0.0) > SHORT_MM):
        row = int(np.argmax(np.abs(missing[:, column])))
        limits = _limits(weights[row : row + 1], int(column), missing[row, column], measurer)
        others = [
            control.title
            for index, control in enumerate(CONTROLS)
            if index != column and control.area == CONTROLS[column].area and not np.isnan(asked[row, index])
        ]
        why = _why(limits, others if exact_curve else None)
        wanted = float(asked[row, column])
        found.append(Shortfall(int(column), row, wanted, wanted - float(missing[row, column]), why))
    return found


def _why(limits: Sequence[str], others: Sequence[str] | None) -> str:
    if limits:
        return f"{' and '.join(limits)} {'is at its limit' if len(limits) == 1 else 'are at their limits'}"
    if others is None:
        return "a believable face goes no further"
    return f"{' and '.join(others[:NAMED])} asked for too" if others else "no weights come nearer"


def _limits(weights: Array, column: int, miss: float, measurer: Measurer) -> tuple[str, ...]:
    """Return the shapes of one frame, (1, 52), that stand at a limit on the side that `miss` mm call for."""
    lever = measurer.jacobian(weights)[0, column] * np.sign(miss) * FREE[CONTROLS[column].area]
    able = np.where(lever > 0, 1.0 - weights[0], weights[0]) * np.abs(lever)  # mm left until the limit
    if able.sum() > np.abs(miss):
        return ()
    held = np.where(able < MET_MM, np.abs(lever), 0.0)
    order = np.argsort(-held)[:NAMED]
    return tuple(SHAPES[shape] for shape in order if held[shape] >= LEVER_MM)


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
