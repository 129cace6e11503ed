"""The head as clay: one signed distance, smoothly blended from solids, and ways to land on its surface."""

from __future__ import annotations

import numpy as np

from engine.lab.modelling.solids import capsule, carve, ellipsoid, turn_y, turn_z, union
from engine.take import Array

EYE_CENTRE = np.array([3.15, 0.0, 7.72])  # of the left eyeball
EYE_RADIUS = 1.40  # slightly larger than life (1.2): stylised


def _mirrored(points: Array) -> Array:
    """Fold points onto the left half; the rounded fold keeps the distance smooth on the midline."""
    folded = points.copy()
    folded[:, 0] = np.sqrt(points[:, 0] ** 2 + 1e-4)
    return folded


def _cranium(q: Array) -> Array:
    d = ellipsoid(q, (0, 3.6, -1.2), (7.25, 7.6, 8.2))
    d = union(d, ellipsoid(q, (0, 3.3, 2.2), (6.5, 7.3, 7.35)), 2.0)  # frontal bone
    return union(d, ellipsoid(q, (0, 1.0, -3.5), (6.0, 5.0, 5.6)), 2.0)  # occiput


def _lower_face(d: Array, q: Array) -> Array:
    d = union(d, ellipsoid(q, (0, -1.8, 3.2), (6.1, 6.2, 5.6)), 2.0)  # mid face
    d = union(d, ellipsoid(q, (0, -6.6, 4.0), (4.6, 4.0, 5.0)), 2.0)
    d = union(d, capsule(q, (4.5, -6.1, 1.6), (1.35, -9.75, 7.5), 0.95, 1.1), 2.6)  # jaw line
    d = union(d, capsule(q, (5.2, -2.0, 1.0), (4.8, -6.0, 1.7), 1.2, 1.0), 2.2)  # angle of the jaw
    return union(d, ellipsoid(q, (0, -6.3, 6.5), (3.35, 2.7, 3.85)), 1.6)  # muzzle


def _cheeks_and_brow(d: Array, q: Array) -> Array:
    d = union(d, ellipsoid(q, (4.0, -2.3, 6.1), (1.8, 1.3, 2.1), turn_z(12)), 2.4)  # cheekbone
    d = union(d, capsule(q, (5.0, -1.9, 4.8), (5.75, -1.4, 1.0), 0.8, 0.7), 2.6)  # its arch to the ear
    d = union(d, ellipsoid(q, (3.3, -4.4, 6.2), (2.1, 2.3, 2.1)), 2.4)  # fat pads
    d = union(d, ellipsoid(q, (3.55, -5.0, 3.4), (1.8, 3.0, 3.0)), 2.4)
    d = union(d, capsule(q, (1.0, 1.45, 8.5), (4.5, 1.75, 6.7), 0.85, 0.75), 1.2)  # brow ridge
    d = union(d, ellipsoid(q, (0, 1.6, 8.3), (1.3, 1.3, 1.2)), 1.2)  # glabella
    return union(d, ellipsoid(q, (0, -9.6, 8.3), (1.85, 1.3, 1.6)), 2.2)  # chin


def _neck(q: Array) -> Array:
    d = capsule(q, (0, -6, -0.9), (0, -19, -2.2), 4.0, 4.6)
    d = union(d, capsule(q, (0, -2.0, -5.6), (0, -13.0, -3.6), 3.0, 3.4), 2.5)  # nape
    d = union(d, capsule(q, (4.6, -4.5, -1.2), (1.6, -18.5, 2.6), 0.8, 0.9), 2.0)  # sternomastoid
    return union(d, ellipsoid(q, (0, -13.4, 2.6), (0.9, 1.5, 1.2)), 1.8)  # larynx


def _nose(q: Array) -> Array:
    d = capsule(q, (0, 0.6, 8.75), (0, -2.75, 10.95), 0.55, 0.56)  # bridge
    d = union(d, ellipsoid(q, (0, -3.10, 11.2), (0.80, 0.68, 0.86)), 0.8)  # tip
    d = union(d, capsule(q, (0.42, 0.0, 8.3), (0.75, -2.9, 9.8), 0.55, 0.75), 0.9)  # side wall
    d = union(d, capsule(q, (0, -3.45, 11.1), (0, -3.95, 9.9), 0.36, 0.36), 0.7)  # columella
    return union(d, ellipsoid(q, (1.15, -3.55, 10.05), (0.56, 0.62, 0.90), turn_y(-14)), 0.55)  # wing


def _sockets(d: Array, q: Array) -> Array:
    d = carve(d, ellipsoid(q, (3.2, -0.15, 9.35), (2.05, 1.25, 1.45), turn_y(12)), 1.3)
    d = carve(d, ellipsoid(q, (1.45, 0.0, 9.6), (0.75, 1.0, 0.9)), 0.9)
    d = union(d, ellipsoid(q, (3.15, -2.05, 7.35), (1.9, 0.9, 1.25), turn_y(12)), 0.9)  # fills under the eye
    d = union(d, np.linalg.norm(q - EYE_CENTRE, axis=1) - (EYE_RADIUS + 0.27), 0.6)  # the eyeball under its lids
    return carve(d, ellipsoid(q, (8.3, 1.2, 5.4), (1.5, 2.4, 2.0)), 2.0)  # temple


def distance(points: Array) -> Array:
    """Return the signed distance of points, (n, 3), to the clay: about right near it, exact in sign."""
    q = _mirrored(points)
    d = _cheeks_and_brow(_lower_face(_cranium(q), q), q)
    d = _sockets(union(d, _neck(q), 1.6), q)
    d = union(d, _nose(q), 0.75)
    return carve(d, capsule(q, (0, -4.6, 11.05), (0, -5.5, 11.2), 0.22, 0.26), 0.5)  # philtrum


def gradient(points: Array, step: float = 1e-3) -> Array:
    """Return the gradient of the distance, (n, 3), by central differences."""
    slope = np.zeros_like(points)
    for axis in range(3):
        offset = np.zeros(3)
        offset[axis] = step
        slope[:, axis] = (distance(points + offset) - distance(points - offset)) / (2 * step)
    return slope


def normals(points: Array) -> Array:
    """Return the unit normals of the clay at points, (n, 3)."""
    slope = gradient(points)
    return np.asarray(slope / (np.linalg.norm(slope, axis=1, keepdims=True) + 1e-9))


def project(points: Array, rounds: int = 3, longest_step: float = 0.6) -> Array:
    """Move points, (n, 3), onto the surface along the gradient."""
    for _ in range(rounds):
        slope = gradient(points)
        step = -(distance(points) / np.maximum((slope * slope).sum(axis=1), 0.15))[:, None] * slope
        length = np.linalg.norm(step, axis=1, keepdims=True)
        points = points + step * np.minimum(1, longest_step / (length + 1e-9))
    return points


def cast(origins: Array, directions: Array, start: float = 26.0, rounds: int = 140) -> Array:
    """Return where rays, marching inwards from `start` along their directions, first meet the clay, (n, 3)."""
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    along = np.full(len(origins), start)
    for _ in range(rounds):
        along -= np.clip(distance(origins + along[:, None] * unit), -0.2, 3.0) * 0.7
    return np.asarray(origins + along[:, None] * unit)


def cast_forward(x: Array, y: Array) -> Array:
    """Return the points of the face seen straight from the front at x, y, (n, 3)."""
    return cast(np.column_stack([x, y, np.zeros_like(x)]), np.tile([0.0, 0.0, 1.0], (len(x), 1)))
