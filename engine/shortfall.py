"""The targets that an edit did not reach, and why."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from engine.controls import ALL_CONTROLS
from engine.extended import bundled_face
from engine.regress.solve import FREE
from engine.take import SHAPES, Array

SHORT = 0.5  # mm or degrees; misses that are reported
LEVER = 0.75  # a shape at its limit is why, when its full range would move the control by at least this
AT_LIMIT = 1e-3  # mm that a shape could still bring
NAMED = 2  # limits at most that a sentence lists


@dataclass(frozen=True)
class Shortfall:
    """The frame at which a control misses its target most.

    Attributes
    ----------
    control : its column
    row : which of the frames
    asked, reached : in the control's unit
    why : the reason, as the screen shows it
    believed : whether the plausibility limit is the reason: the face itself could go further
    """

    control: int
    row: int
    asked: float
    reached: float
    why: str
    believed: bool

    def __str__(self) -> str:
        control = ALL_CONTROLS[self.control]
        return f"{control.title} {self.reached:.1f} {control.unit} of {self.asked:.1f} asked: {self.why}"


def shortfalls(weights: Array, asked: Array, *, believability: float, granted: Array | None = None) -> list[Shortfall]:
    """Return each control that misses by more than `SHORT`, at its worst frame.

    `weights` are (frames, 52), `asked` (frames, 16) with NaN for no target, `believability` that of the edit;
    `granted`, (frames, 16), are the targets within the plausibility limit, where known.
    """
    missing = np.nan_to_num(asked - bundled_face().measure(weights))
    found = []
    for column in np.flatnonzero(np.abs(missing).max(axis=0, initial=0.0) > SHORT).tolist():
        row = int(np.argmax(np.abs(missing[:, column])))
        met = granted is not None and abs(granted[row, column] - asked[row, column] + missing[row, column]) < SHORT / 5
        limits = () if met else _limits(weights[row : row + 1], column, missing[row, column])
        others = [
            control.title
            for index, control in enumerate(ALL_CONTROLS)
            if index != column and control.area == ALL_CONTROLS[column].area and not np.isnan(asked[row, index])
        ]
        target = float(asked[row, column])
        why = _why(limits, others, believable=believability > 0)
        believed = believability > 0 and not limits
        found.append(Shortfall(column, row, target, target - float(missing[row, column]), why, believed))
    return found


def _why(limits: Sequence[str], others: Sequence[str], *, believable: bool) -> str:
    if limits:
        return f"{' and '.join(limits)} {'is at its limit' if len(limits) == 1 else 'are at their limits'}"
    if believable:
        return "neither this take nor the recordings go further"
    return f"{' and '.join(others[:NAMED])} asked for too" if others else "no weights come nearer"


def _limits(weights: Array, column: int, miss: float) -> tuple[str, ...]:
    """Return the shapes of one frame, (1, 52), that stand at a limit on the side that `miss` calls for."""
    _, slope = bundled_face().jacobian(weights, np.array([column]))
    lever = slope[0, 0] * np.sign(miss) * FREE[ALL_CONTROLS[column].area]
    able = np.where(lever > 0, 1.0 - weights[0], weights[0]) * np.abs(lever)  # left until the limit
    if able.sum() > np.abs(miss):
        return ()
    limited = np.where(able < AT_LIMIT, np.abs(lever), 0.0)
    order = np.argsort(-limited)[:NAMED]
    return tuple(SHAPES[shape] for shape in order if limited[shape] >= LEVER)
