"""Every curve that can stand in a lane: the controls, then the weights they expand to."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from engine.controls import CONTROLS, bundled_measurer
from engine.take import SHAPES

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
        return 0.0

    @property
    def highest(self) -> float:
        """The most it can be asked to be."""
        return 1.0 if self.is_weight else np.inf

    def shown(self, value: float) -> str:
        """Return a value as the screen writes it."""
        return f"{value:.2f}" if self.is_weight else f"{value:.1f} {self.unit}"


CURVES: tuple[Curve, ...] = (
    *(Curve(control.title, control.unit, column, False) for column, control in enumerate(CONTROLS)),
    *(Curve(shape, "", column, True) for column, shape in enumerate(SHAPES)),
)
FIRST_WEIGHT = len(CONTROLS)


@lru_cache(maxsize=len(CONTROLS))
def weights_under(control: int) -> tuple[int, ...]:
    """Return the lanes of the weights that move a control, those that move it most first."""
    measurer = bundled_measurer()
    # measured on a slightly open mouth, since mouthClose does nothing to a closed one
    pose = np.zeros((1, len(SHAPES)))
    pose[0, SHAPES.index("jawOpen")] = 0.2
    slope = np.abs(measurer.jacobian(pose)[0, control])
    order = np.argsort(-slope)
    return tuple(FIRST_WEIGHT + int(shape) for shape in order if slope[shape] >= MOVES_MM)
