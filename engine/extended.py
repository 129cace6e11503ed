"""All sixteen controls measured at once: the eight distances, brows, the jaw's sideways place, gaze, corner heights.

The points of the further ones are found from what the shapes move, so that any character with the shapes has them.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from engine.character import Character, bundled
from engine.controls import ALL_CONTROLS, CONTROLS, EXTENDED
from engine.jaw import CLOSE, JAW, ahead, limited
from engine.take import SHAPE_INDEX, SHAPES, Array, Mask

EXTENDED_INDEX: dict[str, int] = {control.name: len(CONTROLS) + index for index, control in enumerate(EXTENDED)}
LENGTH, PLACE, ANGLE = range(3)
# Of each control, the vectors that it is the mean over, each by its row, what is read of it, and along which axis.
TERMS: tuple[tuple[tuple[int, int, int], ...], ...] = (
    *(((row, LENGTH, 0),) for row in range(10)),  # the eight distances, right and left brow
    ((10, LENGTH, 0), (11, LENGTH, 0)),  # inner brows
    ((12, PLACE, 0),),  # chin
    ((13, ANGLE, 0), (14, ANGLE, 0)),  # pupils
    ((13, ANGLE, 1), (14, ANGLE, 1)),
    ((15, PLACE, 1),),  # corners of the mouth
    ((16, PLACE, 1),),
)
_EVERY = np.arange(len(ALL_CONTROLS))
_LEAST_MM, _LEAST_FORWARD_MM = 1e-9, 1e-3

Columns = npt.NDArray[np.int64]


class Gauges:
    """Some controls, and their derivatives by some shapes: a drag step needs few of either.

    Parameters
    ----------
    rest, basis : (17, 3) and (52, 17, 3) in mm, the vectors that controls are read of
    columns : which controls
    shapes : which shapes
    """

    def __init__(self, rest: Array, basis: Array, *, columns: Columns, shapes: Columns) -> None:
        terms = [(place, *term) for place, column in enumerate(columns.tolist()) for term in TERMS[column]]
        place, rows, kind, axis = np.array(terms).T
        self._rest, self._basis = rest[rows], basis[:, rows].reshape(len(SHAPES), -1)
        self._slopes = np.ascontiguousarray(basis[shapes][:, rows].transpose(1, 2, 0))  # (terms, 3, shapes)
        self._close = basis[CLOSE, rows]  # (terms, 3)
        self._jaw_at, self._close_at = np.flatnonzero(shapes == JAW), np.flatnonzero(shapes == CLOSE)
        self._first = np.flatnonzero(np.diff(place, prepend=-1))  # term of each control
        self._pairs = np.flatnonzero(np.diff(self._first, append=len(place)) > 1)  # controls of two terms
        self._places, self._angles = np.flatnonzero(kind == PLACE), np.flatnonzero(kind == ANGLE)
        self._axis = axis

    def vectors(self, weights: Array) -> Array:
        """Return the vectors, (frames, terms, 3) in mm, at weights, (frames, 52)."""
        moved = limited(weights) @ self._basis
        return np.asarray(self._rest + moved.reshape(len(weights), -1, 3))

    def read(self, vectors: Array) -> Array:
        """Return the controls, (frames, controls), of vectors."""
        terms = np.sqrt((vectors**2).sum(axis=-1))
        for term in self._places.tolist():
            terms[:, term] = vectors[:, term, self._axis[term]]
        for term in self._angles.tolist():
            forward = np.maximum(vectors[:, term, 2], _LEAST_FORWARD_MM)
            terms[:, term] = np.degrees(np.arctan2(vectors[:, term, self._axis[term]], forward))
        return self._means(terms)

    def slopes(self, vectors: Array, joined: Mask) -> Array:
        """Return d control / d weight, (frames, controls, shapes).

        `joined`, (frames,), tells where the lips close as far as the jaw has opened: `Gauges.joined`.
        """
        gradient = vectors / np.maximum(np.sqrt((vectors**2).sum(axis=-1, keepdims=True)), _LEAST_MM)
        for term in self._places.tolist():
            gradient[:, term] = np.eye(3)[self._axis[term]]
        for term in self._angles.tolist():
            gradient[:, term] = _angle_gradient(vectors[:, term], int(self._axis[term]))
        slopes = (gradient.transpose(1, 0, 2) @ self._slopes).transpose(1, 0, 2)  # many times as fast as einsum
        return self._means(self._joined(slopes, (gradient * self._close).sum(axis=-1), joined))

    def vector(self, vectors: Array, column: int) -> Array:
        """Return the vector, (frames, 3) in mm, whose length the control at this place is."""
        return np.asarray(vectors[:, self._first[column]])

    def coordinate_slopes(self, column: int, joined: Mask) -> Array:
        """Return d vector / d weight, (frames, 3, shapes), of that vector."""
        term = self._first[column]
        slopes = np.tile(self._slopes[term], (len(joined), 1, 1))
        return self._joined(slopes, np.tile(self._close[term], (len(joined), 1)), joined)

    @staticmethod
    def joined(weights: Array) -> Mask:
        """Return in which frames mouthClose is ahead of the jaw, and follows that instead of its own weight."""
        return ahead(weights)

    def _joined(self, slopes: Array, of_close: Array, joined: Mask) -> Array:
        if joined.any():
            slopes[:, :, self._jaw_at] += (of_close * joined[:, None])[:, :, None]
            slopes[:, :, self._close_at] *= ~joined[:, None, None]
        return slopes

    def _means(self, terms: Array) -> Array:
        """Return the mean, (frames, controls, ...), over each control's terms, (frames, terms, ...)."""
        if not len(self._pairs):
            return terms
        means = terms[:, self._first]
        means[:, self._pairs] = (means[:, self._pairs] + terms[:, self._first[self._pairs] + 1]) / 2
        return means


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
        rest_vectors = np.concatenate([ends - starts, rest[vertices] - origins])  # (17, 3) mm
        basis = np.concatenate([end_deltas - start_deltas, deltas[:, vertices]], axis=1)  # (52, 17, 3) mm
        self._vectors = rest_vectors, basis
        self._known: dict[tuple[bytes, bytes], Gauges] = {}

    @property
    def linear(self) -> tuple[Array, Array]:
        """Return the vectors that controls are read of at rest, (17, 3), and their basis, (52, 17, 3), both in mm."""
        return self._vectors

    def gauges(self, columns: Columns = _EVERY, shapes: Columns | None = None) -> Gauges:
        """Return these controls alone, by these shapes or all of them."""
        shapes = np.arange(len(SHAPES)) if shapes is None else shapes
        key = columns.tobytes(), shapes.tobytes()
        if key not in self._known:
            self._known[key] = Gauges(*self._vectors, columns=columns, shapes=shapes)
        return self._known[key]

    def measure(self, weights: Array) -> Array:
        """Return (frames, 16) in mm and degrees, columns as `ALL_CONTROLS`, of weights, (frames, 52)."""
        every = self.gauges()
        return every.read(every.vectors(weights))

    def jacobian(self, weights: Array, columns: Columns) -> tuple[Array, Array]:
        """Return measured controls, (frames, columns), and d control / d weight, (frames, columns, 52), at weights."""
        gauges = self.gauges(columns)
        vectors = gauges.vectors(weights)
        return gauges.read(vectors), gauges.slopes(vectors, gauges.joined(weights))


def _angle_gradient(vectors: Array, axis: int) -> Array:
    """Return the derivative, (frames, 3) in degrees per mm, of the angle from straight ahead of vectors, (frames, 3)."""
    gradient = np.zeros_like(vectors)
    forward = np.maximum(vectors[:, 2], _LEAST_FORWARD_MM)
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
