"""The head as clay: one signed distance, smoothly blended from solids, and projections onto its surface.

The solids' places and radii are fitted to some 150 points measured on scanned faces: ``sum distance(p)^2`` plus a penalty
on their change, by least squares (`engine.lab.sculpting.fitting`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from engine.lab.modelling.solids import capsule, carve, ellipsoid, turn_x, turn_y, turn_z, union
from engine.take import Array

Vector = tuple[float, float, float]
EYE_CENTRE = np.array([3.15, 0.0, 7.72])  # of the left eyeball
EYE_RADIUS = 1.36  # slightly larger than life (1.2): stylised
LID_THICKNESS = 0.27


@dataclass(frozen=True)
class Ellipsoid:
    """An ellipsoid of the left half: centre and radii in cm, turned about x, y, z in degrees."""

    centre: Vector
    radii: Vector
    turn: Vector = (0.0, 0.0, 0.0)
    rounding: float = 0.0
    carves: bool = False

    def distance(self, points: Array) -> Array:
        """Return the signed distance of points, (n, 3)."""
        turn = turn_z(self.turn[2]) @ turn_y(self.turn[1]) @ turn_x(self.turn[0]) if any(self.turn) else None
        return ellipsoid(points, self.centre, self.radii, turn)


@dataclass(frozen=True)
class Rod:
    """A round rod from one end to the other, in cm, with a radius at each end."""

    start: Vector
    end: Vector
    radii: tuple[float, float]
    rounding: float = 0.0
    carves: bool = False

    def distance(self, points: Array) -> Array:
        """Return the signed distance of points, (n, 3)."""
        return capsule(points, self.start, self.end, *self.radii)


Solid = Ellipsoid | Rod
HEAD = (
    Ellipsoid((0, 3.12, -0.56), (8.07, 7.98, 8.37), rounding=0),  # cranium
    Ellipsoid((0, 1.73, 2.67), (7.48, 8.6, 7.93), rounding=2),  # frontal bone
    Ellipsoid((0, 0.41, -3.1), (6.83, 7.22, 5.54), rounding=2),  # occiput
    Ellipsoid((0, -2.29, 3.58), (7.22, 6.6, 5.91), rounding=2),  # mid face
    Ellipsoid((0, -7.12, 5.02), (5.66, 5.25, 5.82), rounding=2),  # lower face
    Rod((5.14, -5.79, 1.45), (1.44, -10.26, 8.54), (1, 1.08), rounding=2.6),  # jaw line
    Rod((5.78, -1.99, 0.7), (5.53, -6.93, 1.41), (1.2, 1.02), rounding=2.2),  # angle of the jaw
    Ellipsoid((0, -6.73, 7.59), (3.08, 2.89, 4.3), rounding=1.6),  # muzzle
    Ellipsoid((4.5, -3, 6.45), (1.83, 1.31, 2.1), turn=(0, 0, 12), rounding=2.4),  # cheekbone
    Rod((4.93, -1.9, 4.78), (6.13, -1.41, 0.78), (0.8, 0.7), rounding=2.6),  # its arch to the ear
    Ellipsoid((3.09, -4.51, 7.37), (2.12, 2.5, 2.23), rounding=2.4),  # fat pad
    Ellipsoid((4.59, -5.75, 3.88), (1.88, 3.29, 3.39), rounding=2.4),  # cheek
    Rod((1.81, 2.74, 9.87), (5.01, 1.44, 8.27), (0.91, 0.81), rounding=1.2),  # brow ridge
    Ellipsoid((0, 1.8, 9.04), (1.41, 1.4, 1.3), rounding=1.2),  # glabella
    Ellipsoid((0, -10.33, 9.03), (1.91, 1.36, 1.88), rounding=2),  # chin
)
NECK = (
    Rod((0, -6.85, 0.7), (0, -21.63, -3.83), (4.99, 6.68), rounding=0),  # throat
    Rod((0, -1.88, -3), (0, -13.67, -2.8), (2.95, 2.56), rounding=2.5),  # nape
    Rod((5.93, -4.74, -1.54), (3.2, -21.33, 2.4), (0.99, 1.02), rounding=2),  # sternomastoid
    Ellipsoid((0, -13.3, 4.05), (1.16, 1.61, 1.31), rounding=1.8),  # larynx
)
SOCKETS = (
    Ellipsoid((2.63, -0.15, 10.31), (2.09, 1.14, 1.43), turn=(0, 12, 0), rounding=1.3, carves=True),  # socket
    Ellipsoid((1.44, -0.37, 10.36), (0.75, 0.99, 0.89), rounding=0.9, carves=True),  # its inner corner
    Ellipsoid((3.13, -2.1, 7.52), (1.9, 0.9, 1.25), turn=(0, 12, 0), rounding=0.9),  # under the eye
    Ellipsoid((8.83, 1.98, 5.89), (1.48, 2.44, 1.99), rounding=2, carves=True),  # temple
)
NOSE = (
    Rod((0, 0.34, 9.69), (0, -2.94, 12.16), (0.55, 0.62), rounding=0),  # bridge
    Ellipsoid((0, -3.5, 12.12), (0.9, 0.76, 0.9), rounding=0.8),  # tip
    Rod((0.66, 0.1, 9.3), (0.7, -3.0, 11.2), (0.6, 0.78), rounding=0.9),  # side wall
    Rod((0, -4.0, 12.15), (0, -4.5, 11.3), (0.40, 0.42), rounding=0.7),  # columella
    Ellipsoid((1.3, -3.75, 10.95), (0.66, 0.72, 1.0), turn=(0, -14, 0), rounding=0.6),  # wing
)
PHILTRUM = (
    Rod((0, -5.01, 11.81), (0, -5.73, 11.84), (0.22, 0.26), rounding=0.5, carves=True),  # philtrum
)


def _folded(points: Array) -> Array:
    """Fold points onto the left half; the rounded fold keeps the distance smooth on the midline."""
    folded = points.copy()
    folded[:, 0] = np.sqrt(points[:, 0] ** 2 + 1e-4)
    return folded


def _joined(points: Array, solids: Sequence[Solid], body: Array | None = None) -> Array:
    """Return the distance to solids joined to a body, or carved from it, one after the other."""
    for solid in solids:
        own = solid.distance(points)
        if body is None:
            body = own
        elif solid.carves:
            body = carve(body, own, solid.rounding)
        else:
            body = union(body, own, solid.rounding)
    assert body is not None
    return body


def distance_to(
    points: Array,
    *,
    head: Sequence[Solid],
    neck: Sequence[Solid],
    sockets: Sequence[Solid],
    nose: Sequence[Solid],
    philtrum: Sequence[Solid],
) -> Array:
    """Return the signed distance of points, (n, 3), to a clay of these solids."""
    q = _folded(points)
    body = union(_joined(q, head), _joined(q, neck), 1.6)
    body = _joined(q, sockets, body)
    body = union(body, np.linalg.norm(q - EYE_CENTRE, axis=1) - (EYE_RADIUS + LID_THICKNESS), 0.6)
    body = union(body, _joined(q, nose), 0.75)
    return _joined(q, philtrum, body)


def distance(points: Array) -> Array:
    """Return the signed distance of points, (n, 3), to the clay: about right near it, exact in sign."""
    return distance_to(points, head=HEAD, neck=NECK, sockets=SOCKETS, nose=NOSE, philtrum=PHILTRUM)


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
