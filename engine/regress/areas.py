"""The three areas of the face that move with little correlation; each has its own networks (BSBS19 section 4.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from engine.controls import CONTROL_INDEX
from engine.extended import EXTENDED_INDEX
from engine.take import SHAPES

_COLUMNS = CONTROL_INDEX | EXTENDED_INDEX
_UPPER = ("brow", "cheekSquint", "noseSneer")


@dataclass(frozen=True)
class Area:
    """Shapes that one network makes, and the controls it makes them from.

    Gaze is in none of `AREAS`: two lid distances cannot tell where the eyes look, so an edit of the lids leaves gaze as
    it was recorded.
    """

    name: str
    controls: tuple[str, ...]
    prefixes: tuple[str, ...]
    needs_whole_face: bool

    @property
    def control_columns(self) -> npt.NDArray[np.int64]:
        """Columns of the control curves that the network reads."""
        return np.array([_COLUMNS[name] for name in self.controls])

    @property
    def shape_columns(self) -> npt.NDArray[np.int64]:
        """Columns of the weights that the network makes."""
        return np.array([index for index, name in enumerate(SHAPES) if name.startswith(self.prefixes)])


_MOUTH = ("lips_vertical", "lips_horizontal", "corner_right", "corner_left", "nose_to_lip", "chin_to_lip")
AREAS: tuple[Area, ...] = (
    Area("lower", _MOUTH, ("jaw", "mouth", "cheekPuff", "tongue"), False),
    Area("upper", ("eyelid_right", "eyelid_left", "corner_right", "corner_left", "nose_to_lip"), _UPPER, True),
    Area("eyelids", ("eyelid_right", "eyelid_left"), ("eyeBlink", "eyeSquint", "eyeWide"), True),
)

# With the extended controls, these networks replace what the areas above say of their shapes.
EXTENDED_AREAS: tuple[Area, ...] = (
    Area("brows", ("brow_right", "brow_left", "brow_inner"), ("brow",), True),
    Area("jaw", (*_MOUTH, "jaw_sideways"), ("jawRight", "jawLeft", "mouthRight", "mouthLeft"), True),
    Area("gaze", ("gaze_horizontal", "gaze_vertical"), ("eyeLook",), True),
)
