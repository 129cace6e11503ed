"""All sixteen controls measured at once: the eight distances, brows, the jaw's sideways place, gaze, corner heights.

The points of the further ones are found from what the shapes move, so that any character with the shapes has them.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from engine.character import Character, bundled
from engine.controls import ALL_CONTROLS, CONTROLS, EXTENDED, limited
from engine.take import SHAPE_INDEX, SHAPES, Array

EXTENDED_INDEX: dict[str, int] = {control.name: len(CONTROLS) + index for index, control in enumerate(EXTENDED)}
_JAW, _CLOSE = SHAPE_INDEX["jawOpen"], SHAPE_INDEX["mouthClose"]
# Rows of the vectors that controls are measured on; those before are the eight distances.
_BROWS = slice(8, 12)  # right, left, inner, inner mirrored
_CHIN, _PUPILS, _CORNERS = 12, slice(13, 15), slice(15, 17)
_LENGTHS = slice(0, 12)
_FROM = np.zeros((len(ALL_CONTROLS), 17))  # which vectors each control is the mean of
_FROM[np.arange(10), np.arange(10)] = 1.0
_FROM[10, 10:12] = 0.5
_FROM[11, _CHIN] = 1.0
_FROM[12, _PUPILS] = _FROM[13, _PUPILS] = 0.5
_FROM[14, 15] = _FROM[15, 16] = 1.0
_LEAST_MM = 1e-9


class FaceMeasurer:
    """Measures `ALL_CONTROLS` on one character and gives their derivatives.

    Every control is a length, a coordinate or an angle of vectors ``d0 + M w`` between points of the face, or the mean
    of two of these, alike on both sides of the face.
    """

    def __init__(self, character: Character) -> None:
        rest, deltas = character.neutral.astype(np.float64), character.deltas.astype(np.float64)
        starts, start_deltas = character.landmark_positions([control.start for control in CONTROLS])
        ends, end_deltas = character.landmark_positions([control.end for control in CONTROLS])
        eyes = {side: _eye(rest, deltas, side) for side in ("Right", "Left")}
        right, left = (eyes[side][0] for side in ("Right", "Left"))
        inner = _most_moved(deltas, "browInnerUp")
        mirrored = int(character.mirror[inner]) if len(character.mirror) else inner
        raised = [_most_moved(deltas, name) for name in ("browOuterUpRight", "browOuterUpLeft")]
        chin, corners = (
            character.landmarks["chin"],
            [character.landmarks[f"mouth_{side}"] for side in ("right", "left")],
        )
        vertices = [*raised, inner, mirrored, chin, eyes["Right"][1], eyes["Left"][1], *corners]
        middle = (right + left) / 2
        origins = np.array([right, left, middle, middle, rest[chin], right, left, *rest[corners]])
        self._rest = np.concatenate([ends - starts, rest[vertices] - origins])  # (17, 3) mm
        basis = np.concatenate([end_deltas - start_deltas, deltas[:, vertices]], axis=1)  # (52, 17, 3) mm
        self._basis = basis.reshape(len(SHAPES), -1)
        self._slopes = np.ascontiguousarray(basis.transpose(1, 2, 0))  # (17, 3, 52)

    def measure(self, weights: Array) -> Array:
        """Return (frames, 16) in mm and degrees, columns as `ALL_CONTROLS`, of weights, (frames, 52)."""
        return self._read(self._vectors(weights))

    def _vectors(self, weights: Array) -> Array:
        moved = limited(weights) @ self._basis
        return np.asarray(self._rest + moved.reshape(len(weights), -1, 3))

    def _read(self, vectors: Array) -> Array:
        lengths = np.sqrt((vectors[:, _LENGTHS] ** 2).sum(axis=-1))
        inner = lengths[:, 10:12].mean(axis=1, keepdims=True)
        forward = np.maximum(vectors[:, _PUPILS, 2], 1e-3)
        gaze = [np.degrees(np.arctan2(vectors[:, _PUPILS, axis], forward)).mean(axis=1) for axis in (0, 1)]
        return np.concatenate(
            [lengths[:, :10], inner, vectors[:, _CHIN, :1], np.stack(gaze, axis=1), vectors[:, _CORNERS, 1]], axis=1
        )

    def jacobian(self, weights: Array, columns: npt.NDArray[np.int64]) -> tuple[Array, Array]:
        """Return measured controls, (frames, columns), and d control / d weight, (frames, columns, 52), at weights."""
        vectors = self._vectors(weights)
        used = np.flatnonzero(_FROM[columns].any(axis=0))
        slopes = np.empty((len(weights), len(columns), len(SHAPES)))
        for place, column in enumerate(columns.tolist()):
            rows = [row for row in used.tolist() if _FROM[column, row]]
            slopes[:, place] = sum(
                _FROM[column, row] * (_gradient(vectors[:, row], column, row) @ self._slopes[row]) for row in rows
            )
        return self._read(vectors)[:, columns], _joined(slopes, weights)

    def vectors(self, weights: Array, columns: npt.NDArray[np.int64]) -> tuple[Array, Array]:
        """Return the vectors, (frames, n, 3) in mm, whose lengths some of the eight distances are, and their slopes.

        The slopes, (frames, 3 n, 52), are those of all vectors' coordinates, one vector after another.
        """
        slopes = np.tile(self._slopes[columns].reshape(-1, len(SHAPES)), (len(weights), 1, 1))
        return self._vectors(weights)[:, columns], _joined(slopes, weights)


def _joined(slopes: Array, weights: Array) -> Array:
    """Return slopes, (frames, n, 52), where mouthClose follows the jaw instead of its own weight once it is ahead of it."""
    joined = weights[:, _CLOSE] > weights[:, _JAW]
    slopes[joined, :, _JAW] += slopes[joined, :, _CLOSE]
    slopes[joined, :, _CLOSE] = 0.0
    return slopes


def _gradient(vectors: Array, column: int, row: int) -> Array:
    """Return the derivative, (frames, 3), of a control by one of its vectors, (frames, 3)."""
    if row < _LENGTHS.stop:
        return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), _LEAST_MM))
    gradient = np.zeros_like(vectors)
    if row == _CHIN:
        gradient[:, 0] = 1.0
    elif row >= _CORNERS.start:
        gradient[:, 1] = 1.0
    else:
        axis = 0 if ALL_CONTROLS[column].name == "gaze_horizontal" else 1
        forward = np.maximum(vectors[:, 2], 1e-3)
        square = np.maximum(vectors[:, axis] ** 2 + forward**2, _LEAST_MM)
        gradient[:, axis] = np.degrees(forward / square)
        gradient[:, 2] = np.degrees(-vectors[:, axis] / square)
    return gradient


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
def bundled_face() -> FaceMeasurer:
    """Return the measurer on the bundled head."""
    return FaceMeasurer(bundled())
