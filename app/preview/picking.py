"""From space to the picture and back: where dots are drawn, and which vertex lies under the pointer."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from app.preview.camera import FIELD_OF_VIEW_DEG, Camera
from app.preview.lighting import Lighting
from app.session.sides import Side
from engine import character
from engine.character import Character
from engine.framing import framed
from engine.jaw import drawable
from engine.take import Array, Mask

EDGE_ON = 0.05  # cosine between skin and view below which a dot is behind the head
CLOSE = 1e-9


@dataclass(frozen=True, eq=False)
class View:
    """A camera in space and the part of the picture that it fills.

    Attributes
    ----------
    pose : (4, 4) of the camera
    left, width, height : of its part, in pixels
    """

    pose: Array
    left: float
    width: float
    height: float

    @property
    def eye(self) -> Array:
        """Where it is looked from, (3,) mm."""
        return np.asarray(self.pose[:3, 3])

    @property
    def _scale(self) -> float:
        return float(self.height / 2 / np.tan(np.radians(FIELD_OF_VIEW_DEG / 2)))

    def project(self, points: Array) -> Array:
        """Return where points, (n, 3) mm, are on the picture, (n, 2) pixels."""
        seen = (points - self.eye) @ self.pose[:3, :3]
        flat = seen[:, :2] / np.maximum(-seen[:, 2:], CLOSE) * self._scale
        return np.stack([self.left + self.width / 2 + flat[:, 0], self.height / 2 - flat[:, 1]], axis=1)

    def ray(self, x: float, y: float) -> Array:
        """Return the direction, (3,), from the eye through a pixel."""
        ahead = np.array([x - self.left - self.width / 2, self.height / 2 - y, -self._scale])
        return np.asarray(self.pose[:3, :3] @ (ahead / np.linalg.norm(ahead)))


def views(sides: tuple[Side, ...], camera: Camera, width: float, height: float) -> list[View]:
    """Return the view of each side on a picture that they share."""
    each = width / len(sides)
    found = []
    for index, side in enumerate(sides):
        low, high = side.box or framed(side.head or character.bundled())
        found.append(View(camera.pose(low, high, aspect=each / height), index * each, each, height))
    return found


def places(side: Side) -> Array:
    """Return where the dots of a side are, (n, 3) mm."""
    alone = np.array([dot.place for dot in side.dots]).reshape(-1, 3)
    if side.weights is None:
        return alone
    head, vertices = side.head or character.bundled(), [dot.vertex for dot in side.dots]
    used = drawable(np.asarray(side.weights, np.float32)).astype(np.float64)
    return np.asarray(head.neutral[vertices] + np.tensordot(used, head.deltas[:, vertices], axes=1), np.float64)


def facing(side: Side, view: View, at: Array) -> Mask:
    """Return which dots of a side, at (n, 3) mm, are on skin that faces the viewer; points alone all do."""
    seen: Mask = np.asarray(np.isfinite(at).all(axis=1))
    if side.weights is None:
        return seen
    outwards = _normals(side.head or character.bundled())[[dot.vertex for dot in side.dots]]
    towards = view.eye - at
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    return np.asarray(seen & (np.einsum("nx,nx->n", outwards, towards) > EDGE_ON))


def vertex_under(head: Character, weights: Array, view: View, x: float, y: float) -> int | None:
    """Return the visible vertex nearest to a pixel: a corner of the first triangle that the ray through it meets.

    Moeller and Trumbore's test on the triangles whose picture is about the pixel; None where the ray meets none.
    """
    vertices = head.vertices(weights).astype(np.float64)
    flat = view.project(vertices)
    about = _around(flat[:, 0], x, head.triangles) & _around(flat[:, 1], y, head.triangles)
    near = head.triangles[about]
    hit = _first_hit(vertices[near], view.eye, view.ray(x, y))
    if hit is None:
        return None
    away = np.linalg.norm(flat[near[hit]] - (x, y), axis=1)
    return int(near[hit][np.argmin(away)])


def _around(place: Array, wanted: float, triangles: npt.NDArray[np.int32]) -> Mask:
    """Return which triangles reach from one side of a coordinate, (vertices,), to the other."""
    beyond = (place > wanted).astype(np.int8)  # sums over columns: a minimum over three is twenty times slower
    count = beyond[triangles[:, 0]] + beyond[triangles[:, 1]] + beyond[triangles[:, 2]]
    return np.asarray((count > 0) & (count < 3))


def _first_hit(corners: Array, eye: Array, direction: Array) -> int | None:
    edge, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(direction, other)
    flat = np.einsum("tx,tx->t", edge, across)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1.0 / flat
        from_corner = eye - corners[:, 0]
        u = np.einsum("tx,tx->t", from_corner, across) * inverse
        normal = np.cross(from_corner, edge)
        v = normal @ direction * inverse
        depth = np.einsum("tx,tx->t", normal, other) * inverse
        met = (np.abs(flat) > CLOSE) & (u >= 0) & (v >= 0) & (u + v <= 1) & (depth > 0)
    if not met.any():
        return None
    return int(np.argmin(np.where(met, depth, np.inf)))


@lru_cache(maxsize=4)
def _normals(head: Character) -> npt.NDArray[np.float32]:
    return Lighting(head).normals(head.neutral)
