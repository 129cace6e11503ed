"""Signed distances of simple solids, and ways to blend them smoothly into one."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from engine.easing import ease
from engine.take import Array


def smooth_step(start: float, end: float, x: npt.ArrayLike) -> Array:
    """Return 0 before `start`, 1 after `end`, and a cubic between; `end` may lie below `start`."""
    t = np.clip((np.asarray(x, np.float64) - start) / (end - start), 0.0, 1.0)
    return ease(t)


def mix(start: npt.ArrayLike, end: npt.ArrayLike, share: npt.ArrayLike) -> Array:
    """Return the straight blend of two arrays, `share` of the second."""
    first, second = np.asarray(start, np.float64), np.asarray(end, np.float64)
    return np.asarray(first + (second - first) * np.asarray(share, np.float64))


def bell(points: Array, centre: npt.ArrayLike, spread: npt.ArrayLike) -> Array:
    """Return a Gaussian bump over points, (n, 3): 1 at the centre, 1/e one spread away."""
    return np.asarray(np.exp(-(((points - np.asarray(centre)) / np.asarray(spread)) ** 2).sum(axis=1)))


def union(a: Array, b: Array, rounding: float) -> Array:
    """Join two solids with a fillet `rounding` wide (Quilez' cubic smooth minimum)."""
    overlap = np.maximum(rounding - np.abs(a - b), 0.0) / rounding
    return np.asarray(np.minimum(a, b) - overlap**3 * rounding / 6.0)


def carve(body: Array, tool: Array, rounding: float) -> Array:
    """Take one solid out of another, with an edge rounded by `rounding`."""
    return -union(-body, tool, rounding)


def ellipsoid(points: Array, centre: npt.ArrayLike, radii: npt.ArrayLike, turn: Array | None = None) -> Array:
    """Return an estimate, exact at the surface, of the distance to an ellipsoid turned by a (3, 3) rotation."""
    local = points - np.asarray(centre, np.float64)
    if turn is not None:
        local = local @ turn
    size = np.asarray(radii, np.float64)
    scaled = np.linalg.norm(local / size, axis=1)
    slope = np.linalg.norm(local / (size * size), axis=1) + 1e-9
    return np.asarray(scaled * (scaled - 1.0) / slope)


def capsule(points: Array, start: npt.ArrayLike, end: npt.ArrayLike, radius: float, end_radius: float) -> Array:
    """Return the distance to a round rod whose radius runs from one end to the other."""
    a = np.asarray(start, np.float64)
    axis = np.asarray(end, np.float64) - a
    along = np.clip((points - a) @ axis / (axis @ axis), 0, 1)
    nearest = a + along[:, None] * axis
    return np.asarray(np.linalg.norm(points - nearest, axis=1) - (radius + (end_radius - radius) * along))


def turn_x(degrees: float) -> Array:
    """Return the rotation about x."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def turn_y(degrees: float) -> Array:
    """Return the rotation about y."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def turn_z(degrees: float) -> Array:
    """Return the rotation about z."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
