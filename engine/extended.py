"""Six further controls, off by default: brows, the jaw's sideways place, gaze. They have networks of their own.

Their points are found from what the shapes move, so that any character with the shapes has them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from engine.character import Character, bundled
from engine.controls import CONTROLS
from engine.take import SHAPE_INDEX, SHAPES, Array


@dataclass(frozen=True)
class ExtendedControl:
    """One further control, with what the screen says of it."""

    name: str
    title: str
    area: str
    unit: str


EXTENDED: tuple[ExtendedControl, ...] = (
    ExtendedControl("brow_right", "right brow", "brows", "mm"),
    ExtendedControl("brow_left", "left brow", "brows", "mm"),
    ExtendedControl("brow_inner", "inner brows", "brows", "mm"),
    ExtendedControl("jaw_sideways", "jaw sideways", "jaw", "mm"),  # towards the character's left is positive
    ExtendedControl("gaze_horizontal", "gaze sideways", "gaze", "degrees"),  # likewise
    ExtendedControl("gaze_vertical", "gaze up", "gaze", "degrees"),
)
EXTENDED_INDEX: dict[str, int] = {control.name: len(CONTROLS) + index for index, control in enumerate(EXTENDED)}


class ExtendedMeasurer:
    """Measures the further controls on one character: brows from the eyes' centres, the chin, the pupils' direction."""

    def __init__(self, character: Character) -> None:
        rest, deltas = character.neutral.astype(np.float64), character.deltas.astype(np.float64)
        eyes = {side: _eye(rest, deltas, side) for side in ("Right", "Left")}
        centres = {side: centre for side, (centre, _) in eyes.items()}
        anchors = [centres["Right"], centres["Left"], (centres["Right"] + centres["Left"]) / 2]
        raised = [_most_moved(deltas, name) for name in ("browOuterUpRight", "browOuterUpLeft", "browInnerUp")]
        pupils = [eyes["Right"][1], eyes["Left"][1]]
        vertices = [*raised, character.landmarks["chin"], *pupils]
        origins = [*anchors, rest[character.landmarks["chin"]], centres["Right"], centres["Left"]]
        self._rest = rest[vertices] - np.array(origins)  # (6, 3) mm
        self._basis = deltas[:, vertices].reshape(len(SHAPES), -1)  # (52, 18) mm

    def measure(self, weights: Array) -> Array:
        """Return (frames, 6) in mm and degrees, columns as `EXTENDED`, of weights, (frames, 52)."""
        vectors = self._rest + (weights @ self._basis).reshape(len(weights), -1, 3)
        brows = np.linalg.norm(vectors[:, :3], axis=-1)
        jaw = vectors[:, 3:4, 0]
        forward = np.maximum(vectors[:, 4:, 2], 1e-3)
        sideways, up = (np.degrees(np.arctan2(vectors[:, 4:, axis], forward)).mean(axis=1) for axis in (0, 1))
        return np.concatenate([brows, jaw, sideways[:, None], up[:, None]], axis=1)


def _most_moved(deltas: Array, shape: str) -> int:
    return int(np.argmax(np.linalg.norm(deltas[SHAPE_INDEX[shape]], axis=-1)))


def _eye(rest: Array, deltas: Array, side: str) -> tuple[Array, int]:
    """Return the centre of the sphere through what looking outwards moves, (3,) mm, and the vertex furthest forward."""
    moved = np.linalg.norm(deltas[SHAPE_INDEX[f"eyeLookOut{side}"]], axis=-1)
    ball = np.flatnonzero(moved > 0.2 * moved.max())
    points = rest[ball]
    system = np.concatenate([2 * points, np.ones((len(points), 1))], axis=1)
    centre = np.linalg.lstsq(system, (points**2).sum(axis=1), rcond=None)[0][:3]
    return centre, int(ball[np.argmax(points[:, 2])])


@lru_cache(maxsize=1)
def bundled_extended() -> ExtendedMeasurer:
    """Return the measurer on the bundled head."""
    return ExtendedMeasurer(bundled())
