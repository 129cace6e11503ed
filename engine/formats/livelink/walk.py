"""Following the clock of a file from row to row: which frame each row is, and which stamps are not believed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from engine.take import Array

MAX_FRAMES = 1_000_000  # over four hours at 60 fps
LONGEST_PAUSE_S = 1800.0  # a longer one is no part of a performance: what follows it follows at once
FEW_FRAMES = 8  # that are missing by whole steps of the clock
AHEAD = 9  # rows that are asked whether a jump of the clock is one
GAIN = 0.2  # share of a row's deviation by which the next is expected elsewhere [0.1..0.3]; fewer odd rows in uneven clocks


@dataclass(frozen=True, eq=False)
class Walked:
    """What following a clock row by row came to.

    Attributes
    ----------
    rows : (rows,) frame of each row
    odd : rows whose stamp was not believed
    set_back : rows from which on the clock is behind
    pauses : seconds of those that were left out
    """

    rows: npt.NDArray[np.int64]
    odd: list[int]
    set_back: list[int]
    pauses: list[float]

    @property
    def uneven(self) -> bool:
        """Whether the clock goes back and forth by itself, and was not set."""
        return len(self.set_back) > max(3, 0.005 * len(self.rows)) and not self.pauses


def walk(times: Array, step_s: float, quantum_s: float) -> Walked:
    """Follow a clock from row to row, and say which frame each is.

    A row is expected one step after the one before. It is later by a frame or more: frames are missing, if most of the
    rows after it say the same, and else its stamp is odd. It is earlier: rows are never before those above them, so that
    it is the next frame, and the clock was set back, or the stamp is odd, as the rows after it say.
    """
    deviations = times / step_s - np.arange(
        len(times)
    )  # rises where rows are missing, falls where the clock is set back
    coarse = quantum_s / step_s
    late = 0.5 + 0.25 * min(1.0, 2 * coarse) + 0.5 * max(0.0, coarse - 1)
    if np.abs(np.diff(times) / step_s - 1).max() < 0.3:
        return Walked(np.arange(len(times)), [], [], [])
    values = deviations.tolist()
    expected = _first(deviations, step_s, late)
    increments = np.ones(len(values), np.int64)
    odd, set_back, pauses = [], [], []
    total = len(values)
    for row, value in enumerate(values):
        off = value - expected
        if abs(off) < late:
            expected += GAIN * off
            continue
        agreed = float(np.median(deviations[row : row + AHEAD])) - expected
        if abs(agreed) < late or (agreed > 0) != (off > 0) or (off > agreed + late):
            odd.append(row)
            continue
        if off < 0:
            set_back.append(row)
            expected += agreed
            continue
        if off * step_s > LONGEST_PAUSE_S or total + off > MAX_FRAMES or _ends_oddly(row, off * step_s, len(values)):
            pauses.append(off * step_s)
        else:
            increments[row] = 1 + round(off)
            total += round(off)
            if off < FEW_FRAMES:  # as many steps as are missing; a pause may end between two of them
                expected += round(off)
                continue
        expected = value
    increments[0] = 0
    return Walked(np.cumsum(increments), odd, set_back, pauses)


def _first(deviations: Array, step_s: float, late: float) -> float:
    """Return what to expect of the first row: what it says, unless those after it say something quite different."""
    most = float(np.median(deviations[: 2 * AHEAD]))
    far = abs(float(deviations[0]) - most) > max(late, 1.0 / step_s)
    return most if far else float(deviations[0])


def _ends_oddly(row: int, jump_s: float, rows: int) -> bool:
    """Whether a jump of more than a second is seen by the last row or two alone: that is a stamp, and no pause."""
    return rows - row <= 2 and jump_s > 1.0
