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

    Attributes
    ----------
    further : controls that the network reads beside, where they are known
    held : controls that its face is brought onto
    """

    name: str
    controls: tuple[str, ...]
    prefixes: tuple[str, ...]
    needs_whole_face: bool
    further: tuple[str, ...] = ()
    held: tuple[str, ...] = ()

    @property
    def control_columns(self) -> npt.NDArray[np.int64]:
        """Columns of the control curves that the network reads."""
        return np.array([_COLUMNS[name] for name in self.controls])

    @property
    def every_column(self) -> npt.NDArray[np.int64]:
        """Columns of these and of the further ones."""
        return np.array([_COLUMNS[name] for name in self.controls + self.further])

    @property
    def held_inputs(self) -> dict[str, int]:
        """The controls that are held and their places among the inputs."""
        inputs = self.controls + self.further
        return {name: inputs.index(name) for name in self.held}

    @property
    def shape_columns(self) -> npt.NDArray[np.int64]:
        """Columns of the weights that the network makes."""
        return np.array([index for index, name in enumerate(SHAPES) if name.startswith(self.prefixes)])


_MOUTH = ("lips_vertical", "lips_horizontal", "corner_right", "corner_left", "nose_to_lip", "chin_to_lip")
_LIDS = ("eyelid_right", "eyelid_left")
_BROWS = ("brow_right", "brow_left", "brow_inner")
_ASIDE = ("jaw_sideways", "corner_height_right", "corner_height_left")
AREAS: tuple[Area, ...] = (
    Area("lower", _MOUTH, ("jaw", "mouth", "cheekPuff", "tongue"), False, _ASIDE, (*_MOUTH, *_ASIDE)),
    Area("upper", (*_LIDS, *_MOUTH[2:5]), _UPPER, True, ("gaze_vertical",)),
    Area("eyelids", _LIDS, ("eyeBlink", "eyeSquint", "eyeWide"), True, ("gaze_vertical",), _LIDS),
)

# Of one part alone: for edits in which nothing else may move, and in the place of what the areas above say of brows.
EXTENDED_AREAS: tuple[Area, ...] = (
    Area("brows", _BROWS, ("brow",), True, held=_BROWS),
    Area("jaw", (*_MOUTH, "jaw_sideways"), ("jawRight", "jawLeft", "mouthRight", "mouthLeft"), True),
    Area("gaze", ("gaze_horizontal", "gaze_vertical"), ("eyeLook",), True),
)
