"""A mesh that moves, before it is a file."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from engine.take import Array


@dataclass(frozen=True, eq=False)
class MovingMesh:
    """A mesh over time.

    Attributes
    ----------
    rest : (n, 3) mm
    triangles : (t, 3)
    frames : (frames, n, 3) float32, mm
    fps : frames per second
    """

    rest: Array
    triangles: npt.NDArray[np.int32]
    frames: npt.NDArray[np.float32]
    fps: float
