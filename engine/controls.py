"""The control parameters: distances on the face that anyone can read (BSBS19 figure 4), in mm.

Blendshapes are linear, so the vector between two landmarks is ``d0 + M w`` with a (3, 52) matrix M: a whole take is
measured in one product, and the derivative comes with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from engine.character import Character, bundled
from engine.errors import EditError
from engine.jaw import follow, limited
from engine.take import SHAPES, Array


@dataclass(frozen=True)
class Control:
    """One control, with what the screen says of it.

    Attributes
    ----------
    start, end : the landmarks whose distance it is; empty where `engine.extended` measures it
    area : which part of the face it speaks of
    signed : whether it may be below zero, as a place or an angle may and a distance may not
    """

    name: str
    title: str
    start: str
    end: str
    area: str
    unit: str = "mm"
    signed: bool = False


CONTROLS: tuple[Control, ...] = (
    Control("lips_vertical", "lips apart", "lip_inner_upper", "lip_inner_lower", "lower"),
    Control("lips_horizontal", "mouth width", "mouth_right", "mouth_left", "lower"),
    Control("eyelid_right", "right eye", "lid_upper_right", "lid_lower_right", "eyelids"),
    Control("eyelid_left", "left eye", "lid_upper_left", "lid_lower_left", "eyelids"),
    Control("corner_right", "right corner", "lip_upper", "mouth_right", "lower"),
    Control("corner_left", "left corner", "lip_upper", "mouth_left", "lower"),
    Control("nose_to_lip", "nose to lip", "nose_bridge", "lip_upper", "lower"),
    Control("chin_to_lip", "chin to lip", "chin", "lip_lower", "lower"),
)
# Off by default. Sideways, the character's left is positive; the height of a corner is 0 on the face at rest.
EXTENDED: tuple[Control, ...] = (
    Control("brow_right", "right brow", "", "", "brows"),
    Control("brow_left", "left brow", "", "", "brows"),
    Control("brow_inner", "inner brows", "", "", "brows"),
    Control("jaw_sideways", "jaw sideways", "", "", "lower", signed=True),
    Control("gaze_horizontal", "gaze sideways", "", "", "gaze", "degrees", signed=True),
    Control("gaze_vertical", "gaze up", "", "", "gaze", "degrees", signed=True),
    Control("corner_height_right", "right corner up", "", "", "lower", signed=True),
    Control("corner_height_left", "left corner up", "", "", "lower", signed=True),
)
ALL_CONTROLS = CONTROLS + EXTENDED
# BSS20 section 5.2: mouth opening, corners and one eyelid are the fewest that tell of mouth and lids.
FEW = ("lips_vertical", "lips_horizontal", "eyelid_left")
CONTROL_INDEX: dict[str, int] = {control.name: index for index, control in enumerate(CONTROLS)}
ALL_INDEX: dict[str, int] = {control.name: index for index, control in enumerate(ALL_CONTROLS)}


def control_index(name: str) -> int:
    """Return the column of a control among `ALL_CONTROLS`; raises `EditError` that lists the names."""
    try:
        return ALL_INDEX[name]
    except KeyError:
        known = ", ".join(ALL_INDEX)
        raise EditError(f"There is no control called {name!r}.", f"Controls are: {known}.") from None


class Measurer:
    """Measures controls on one character.

    Parameters
    ----------
    character : whose landmarks are measured
    controls : which distances, in the order of the columns of every result
    """

    def __init__(self, character: Character, controls: Sequence[Control] = CONTROLS) -> None:
        starts, start_deltas = character.landmark_positions([control.start for control in controls])
        ends, end_deltas = character.landmark_positions([control.end for control in controls])
        self._rest = ends - starts  # (controls, 3)
        self._basis = (end_deltas - start_deltas).reshape(len(SHAPES), -1)  # (52, controls * 3)

    @property
    def linear(self) -> tuple[Array, Array]:
        """Return endpoint differences at rest, (controls, 3), and their basis, (52, controls * 3), both in mm."""
        return self._rest, self._basis

    def _vectors(self, weights: Array) -> Array:
        moved = limited(weights) @ self._basis
        return np.asarray(self._rest + moved.reshape(len(weights), -1, 3))

    def measure(self, weights: Array) -> Array:
        """Return control curves, (frames, controls) in mm, of weights, (frames, 52)."""
        return np.asarray(np.sqrt((self._vectors(weights) ** 2).sum(axis=-1)))

    def jacobian(self, weights: Array) -> Array:
        """Return d control / d weight, (frames, controls, 52) in mm, at weights, (frames, 52)."""
        vectors = self._vectors(weights)
        unit = vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9)
        basis = self._basis.reshape(len(SHAPES), -1, 3)
        slope = (unit.transpose(1, 0, 2) @ basis.transpose(1, 2, 0)).transpose(1, 0, 2)  # many times as fast as einsum
        follow(slope, weights)
        return np.asarray(slope)

    def limits(self, samples: Array) -> Array:
        """Return what a face can reach, (controls, 2) in mm, from weights of many faces, (faces, 52)."""
        measured = self.measure(samples)
        return np.stack([measured.min(axis=0), measured.max(axis=0)], axis=1)


@lru_cache(maxsize=1)
def bundled_measurer() -> Measurer:
    """Return the measurer on the bundled head, on which every take is measured."""
    return Measurer(bundled())


def measure(weights: Array) -> Array:
    """Return the eight control curves, (frames, 8) in mm, on the bundled head."""
    return bundled_measurer().measure(weights)
