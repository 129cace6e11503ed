"""Every curve that can stand in a lane: the controls, then the weights they expand to."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from engine.controls import ALL_CONTROLS
from engine.extended import bundled_face
from engine.take import SHAPES

FARTHEST = 1000.0  # below this no place or angle is
MOVES_MM = 0.75  # a weight belongs under a control when its full range moves the control by at least this


@dataclass(frozen=True)
class Curve:
    """One curve: what the screen calls it, and the column it has among the controls or the weights."""

    title: str
    unit: str
    column: int
    is_weight: bool

    @property
    def lowest(self) -> float:
        """The least it can be."""
        return -FARTHEST if not self.is_weight and ALL_CONTROLS[self.column].signed else 0.0

    @property
    def highest(self) -> float:
        """The most it can be asked to be."""
        return 1.0 if self.is_weight else np.inf

    def shown(self, value: float) -> str:
        """Return a value as the screen writes it."""
        return f"{value:.2f}" if self.is_weight else f"{value:.1f} {self.unit}"


CURVES: tuple[Curve, ...] = (
    *(Curve(control.title, control.unit, column, False) for column, control in enumerate(ALL_CONTROLS)),
    *(Curve(shape, "", column, True) for column, shape in enumerate(SHAPES)),
)
FIRST_WEIGHT = len(ALL_CONTROLS)


@lru_cache(maxsize=len(ALL_CONTROLS))
def weights_under(control: int) -> tuple[int, ...]:
    """Return the lanes of the weights that move a control, those that move it most first."""
    # measured on a slightly open mouth, since mouthClose does nothing to a closed one
    pose = np.zeros((1, len(SHAPES)))
    pose[0, SHAPES.index("jawOpen")] = 0.2
    slope = np.abs(bundled_face().jacobian(pose, np.array([control]))[1][0, 0])
    order = np.argsort(-slope)
    return tuple(FIRST_WEIGHT + int(shape) for shape in order if slope[shape] >= MOVES_MM)
