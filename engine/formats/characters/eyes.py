"""The two eyeballs of a mesh, told by what is round: what says where a face is that has no shapes."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
import numpy.typing as npt

from engine.take import Array

FEWEST, MOST_TRIED = 20, 40  # vertices of a ball, parts that are looked at
CUBE = 2.2  # longest by shortest side of the box about a ball or the half of one that is seen
WIDE = 1.2  # radii: the least that such a part is wide
ROUND = 0.15  # of a ball's radius: how unevenly its vertices lie
ALIKE = 1.15  # one eye's radius by the other's, at most
APART = (2.2, 9.0)  # radii between the eyes' middles; 5.3 on most people, less on cartoons


@dataclass(frozen=True, eq=False)
class Ball:
    """A part that lies on a sphere: centre (3,) and radius in the mesh's unit, and how many vertices it has."""

    centre: Array
    radius: float
    vertices: int


def eyeballs(vertices: Array, triangles: npt.NDArray[np.int32]) -> tuple[Ball, Ball] | None:
    """Return the two largest balls of a mesh, (n, 3), that are alike and as far apart as eyes are; none where there are not."""
    balls = [ball for rows in _compact(vertices, triangles) if (ball := fit_ball(vertices[rows])) is not None]
    pairs = [pair for pair in combinations(balls, 2) if _could_be_eyes(*pair)]
    return max(pairs, key=lambda pair: pair[0].radius, default=None)


def _could_be_eyes(one: Ball, other: Ball) -> bool:
    apart = float(np.linalg.norm(one.centre - other.centre)) / max(one.radius, 1e-300)
    return 1 / ALIKE < one.radius / max(other.radius, 1e-300) < ALIKE and APART[0] < apart < APART[1]


def _compact(vertices: Array, triangles: npt.NDArray[np.int32]) -> list[npt.NDArray[np.int64]]:
    """Return the rows of those parts, largest first, whose box is about a cube."""
    from engine.mesh import parts_of  # it brings scipy, which nothing that only names a head needs

    parts = parts_of(triangles, len(vertices))
    order = np.argsort(parts, kind="stable")
    starts = np.flatnonzero(np.diff(parts[order], prepend=-1))
    low, high = (extreme.reduceat(vertices[order], starts, axis=0) for extreme in (np.minimum, np.maximum))
    box, counts = high - low, np.diff(starts, append=len(order))
    cube = box.max(axis=1) <= CUBE * np.maximum(box.min(axis=1), 1e-300)
    chosen = np.flatnonzero(cube & (counts >= FEWEST))
    largest = chosen[np.argsort(-box[chosen].max(axis=1), kind="stable")][:MOST_TRIED]
    return [order[starts[part] : starts[part] + counts[part]] for part in largest]


def fit_ball(points: Array) -> Ball | None:
    """Return the sphere that points, (n, 3), lie on; none where they lie too unevenly."""
    middle = points.mean(axis=0)
    away = points - middle
    system = np.column_stack([2 * away, np.ones(len(away))])
    solved = np.linalg.lstsq(system, (away**2).sum(axis=1), rcond=None)[0]
    radius = float(np.sqrt(max(solved[3] + solved[:3] @ solved[:3], 0.0)))
    off = np.abs(np.linalg.norm(away - solved[:3], axis=1) - radius)
    wide = float(np.ptp(points, axis=0).max())
    if radius <= 0 or wide < WIDE * radius or np.percentile(off, 90) > ROUND * radius:
        return None
    return Ball(middle + solved[:3], radius, len(points))
