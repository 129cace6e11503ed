"""Splits a head into its connected parts."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from engine.character import Character
from engine.mesh import parts_of
from engine.take import Array

Labels = npt.NDArray[np.int64]  # (vertices,) a number for each part
Triangles = npt.NDArray[np.int32]  # (n, 3)
FEWEST_OF_BALL = 50  # vertices
EYE_RADII_MM, ROUND, HALF = (9.0, 16.0), 0.12, 0.8  # about 12 mm; the cornea stands out by a tenth


def part_of(character: Character) -> Labels:
    """Return which part each vertex belongs to."""
    return parts_of(character.triangles, len(character.neutral))


def shell_and_rest(character: Character, part: Labels) -> tuple[Triangles, Triangles]:
    """Return the triangles of the largest part, whose insides need not be drawn, and all others.

    Leaving out what faces away saves a third of the time on software GL. A part that is wound inwards would vanish,
    and small parts such as brows and lashes are sheets that are seen from both sides: those are drawn whole.
    """
    triangles, vertices = character.triangles, character.neutral.astype(np.float64)
    of_triangle = part[triangles[:, 0]]
    largest = of_triangle == np.bincount(of_triangle).argmax()
    corners = vertices[triangles[largest]] - vertices.mean(axis=0)
    volume = np.einsum("tx,tx->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    if volume <= 0:
        largest[:] = False
    return triangles[largest], triangles[~largest]


def eyeballs(character: Character, part: Labels) -> npt.NDArray[np.int64]:
    """Return the vertices of parts that are balls of an eye's size, or most of one."""
    vertices = character.neutral.astype(np.float64)
    found = [np.flatnonzero(part == label) for label in np.flatnonzero(np.bincount(part) >= FEWEST_OF_BALL)]
    return np.concatenate([np.zeros(0, np.int64), *(rows for rows in found if _is_eyeball(vertices[rows]))])


def _is_eyeball(points: Array) -> bool:
    """Return whether points, (n, 3) in mm, lie on such a ball: ``|p|^2 = 2 c p + r^2 - |c|^2``, solved for c and r."""
    away = points - points.mean(axis=0)
    solved = np.linalg.lstsq(np.column_stack([2 * away, np.ones(len(away))]), (away**2).sum(axis=1))[0]
    radius = float(np.sqrt(max(solved[3] + solved[:3] @ solved[:3], 0.0)))
    off = np.abs(np.linalg.norm(away - solved[:3], axis=1) - radius).max()
    deep = np.ptp(points, axis=0).min() > HALF * radius  # a row of lashes or teeth lies on a ball too
    return EYE_RADII_MM[0] <= radius <= EYE_RADII_MM[1] and bool(deep and off < ROUND * radius)
