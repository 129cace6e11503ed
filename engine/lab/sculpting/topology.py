"""Which vertices the skin has and how they join: a grid of rows and columns with rings round eyes, mouth, nostrils."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from scipy import sparse

from engine.lab.modelling.solids import mix, smooth_step
from engine.lab.sculpting import clay
from engine.take import Array

Loop = list[int]

HALF_COLUMNS = 32  # from the front midline (0) to the back midline
COLUMNS = 2 * HALF_COLUMNS
EYE_RINGS, MOUTH_RINGS, NOSTRIL_RINGS = 11, 15, 3


@dataclass(frozen=True)
class Block:
    """A window in the grid, in rows and signed columns, that rings fill."""

    top: int
    bottom: int
    first: int
    last: int

    def mirrored(self) -> Block:
        """Return the same window on the other half."""
        return Block(self.top, self.bottom, -self.last, -self.first)

    def loop(self, grid: npt.NDArray[np.int64]) -> Loop:
        """Return its border: from half height on the first column over the top to the last, and back below."""
        middle = (self.top + self.bottom) // 2
        places = (
            [(row, self.first) for row in range(middle, self.top, -1)]
            + [(self.top, column) for column in range(self.first, self.last)]
            + [(row, self.last) for row in range(self.top, self.bottom)]
            + [(self.bottom, column) for column in range(self.last, self.first, -1)]
            + [(row, self.first) for row in range(self.bottom, middle, -1)]
        )
        return [int(grid[row, column % COLUMNS]) for row, column in places]


@dataclass(frozen=True)
class Layout:
    """Rays of the grid's rows, (rows, 4): origin y and z, slope in front and at the back; and where the blocks lie."""

    rows: Array
    eye: Block
    nostril: Block
    mouth: Block


def layout() -> Layout:
    """Return the rows from the crown to the neck."""
    rows: list[tuple[float, float, float, float]] = []
    for degrees in (85, 77.5, 70, 62.5, 55, 48, 41, 34.5, 28, 22.5, 17.5):
        slope = float(np.tan(np.radians(degrees)))
        rows.append((2.5, 1.0, slope, slope))
    rows += [(2.5, 1.5, 0.20, 0.22), (2.45, 1.8, 0.10, 0.12), (2.3, 2.0, 0.03, 0.04)]
    eye = len(rows)
    rows += [(y, 2.0, 0, 0) for y in (1.8, 1.25, 0.7, 0.1, -0.5, -1.05, -1.6, -2.05, -2.5, -2.95, -3.4, -3.85)]
    nostril = len(rows)
    rows += [(y, 2.0, 0, 0) for y in (-4.2, -4.45, -4.7)]
    mouth = len(rows)
    rows += [(y, 2.0, 0, 0) for y in (-5.0, -5.55, -6.1, -6.65, -7.1, -7.6, -8.15, -8.7, -9.25)]
    rows += [(y, 2.0, 0, 0) for y in (-9.85, -10.5, -11.15, -11.7)]
    rows += [
        (-10.6, 4.4, -0.27, -0.13),
        (-10.7, 4.4, -0.45, -0.16),
        (-10.8, 4.2, -0.75, -0.20),
        (-10.8, 3.4, -1.15, -0.27),
    ]
    rows += [(y, -0.8, 0, 0) for y in (-14.2, -15.0, -15.9, -16.9, -17.9, -18.9)]
    return Layout(
        rows=np.array(rows, np.float64),
        eye=Block(eye, eye + 6, 3, 15),
        nostril=Block(nostril, nostril + 2, 1, 4),
        mouth=Block(mouth, mouth + 8, -8, 8),
    )


def column_angle(column: Array, y: Array) -> Array:
    """Return the angle of a column from the front in radians: dense at the eyes above, at nose and mouth below."""
    steps = np.abs(column)
    eyes = np.where(steps <= 3, 2.6 * steps, 7.8 + (52 - 7.8) / 12 * (steps - 3))
    mouth = np.where(steps <= 8, 3.65 * steps, 29.2 + (52 - 29.2) / 7 * (steps - 8))
    side = 52 + (180 - 52) * (steps - 15) / (HALF_COLUMNS - 15)
    nose = np.interp(steps, [0, 6, 15], [0, 12.6, 52])
    front = mix(mix(eyes, mouth, smooth_step(-1.7, -5.0, y)), nose, np.exp(-(((y + 4.15) / 0.9) ** 2)))
    return np.radians(np.where(steps <= 15, front, side)) * np.sign(column)


@dataclass
class Builder:
    """A mesh under construction: points, polygons, each vertex's mirror image."""

    points: list[Array] = field(default_factory=list)
    polygons: list[tuple[int, ...]] = field(default_factory=list)
    mirror: dict[int, int] = field(default_factory=dict)

    def add(self, point: npt.ArrayLike = (0, 0, 0)) -> int:
        """Add a vertex and return its index."""
        self.points.append(np.asarray(point, np.float64))
        return len(self.points) - 1

    def add_on_midline(self, point: npt.ArrayLike = (0, 0, 0)) -> int:
        """Add a vertex that is its own mirror image."""
        vertex = self.add(point)
        self.mirror[vertex] = vertex
        return vertex

    def pair(self, left: Sequence[int], right: Sequence[int]) -> None:
        """Note vertices as mirror images of each other."""
        self.mirror.update(zip(left, right, strict=True))
        self.mirror.update(zip(right, left, strict=True))

    def band(self, outer: Loop, inner: Loop, *, flipped: bool = False) -> None:
        """Join two loops of equal length with quads; `flipped` for loops that run clockwise."""
        for here in range(len(outer)):
            there = (here + 1) % len(outer)
            quad = (outer[here], inner[here], inner[there], outer[there])
            self.polygons.append((quad[0], quad[3], quad[2], quad[1]) if flipped else quad)

    def fan(self, loop: Loop, centre: int, *, flipped: bool = False) -> None:
        """Close a loop with triangles to one vertex."""
        for here in range(len(loop)):
            there = (here + 1) % len(loop)
            a, b = (loop[there], loop[here]) if flipped else (loop[here], loop[there])
            self.polygons.append((a, centre, b))

    def rings(self, border: Loop, count: int, *, flipped: bool = False) -> list[Loop]:
        """Add rings within a border, unplaced as yet; returns them with the border first."""
        loops = [border]
        for _ in range(count):
            loops.append([self.add() for _ in border])
            self.band(loops[-2], loops[-1], flipped=flipped)
        return loops


@dataclass(frozen=True)
class Topology:
    """The skin's connectivity; points of the rings are zero until they are shaped.

    Attributes
    ----------
    points : (n, 3), cm
    mirror : (n,) index of each vertex's mirror image
    polygons : triangles and quads
    eyes, nostrils : rings by side, from the grid's border inwards
    mouth : rings from the border inwards; the last holds the one vertex at the back of the mouth
    neck_floor : vertices that close the neck below
    """

    points: Array
    mirror: npt.NDArray[np.int64]
    polygons: list[tuple[int, ...]]
    eyes: dict[str, list[Loop]]
    nostrils: dict[str, list[Loop]]
    mouth: list[Loop]
    neck_floor: Loop

    def triangles(self) -> npt.NDArray[np.int64]:
        """Return the polygons as triangles, (triangles, 3)."""
        split = [(p[0], p[i], p[i + 1]) for p in self.polygons for i in range(1, len(p) - 1)]
        return np.array(split, np.int64)

    def averaging(self) -> sparse.csr_array:
        """Return the (n, n) matrix that replaces a value by the mean of its neighbours'."""
        edges = {
            edge for p in self.polygons for a, b in zip(p, p[1:] + p[:1], strict=True) for edge in ((a, b), (b, a))
        }
        rows, columns = np.array(sorted(edges)).T
        count = len(self.points)
        adjacent = sparse.csr_array((np.ones(len(rows)), (rows, columns)), shape=(count, count))
        return sparse.csr_array(sparse.diags_array(1 / np.maximum(adjacent.sum(axis=1), 1)) @ adjacent)


def skin_topology() -> Topology:
    """Return the skin with its grid cast on the clay and its rings joined but unplaced."""
    plan, mesh = layout(), Builder()
    blocks = [plan.eye, plan.eye.mirrored(), plan.mouth, plan.nostril, plan.nostril.mirrored()]
    grid = _grid(mesh, plan, blocks)
    neck_floor = _close_ends(mesh, plan, grid)
    eyes = _paired_rings(mesh, plan.eye.loop(grid), EYE_RINGS)
    nostrils = _paired_rings(mesh, plan.nostril.loop(grid), NOSTRIL_RINGS)
    for side, loops in nostrils.items():
        loops.append([mesh.add()])
        mesh.fan(loops[-2], loops[-1][0], flipped=side == "right")
    mesh.pair(nostrils["left"][-1], nostrils["right"][-1])
    mouth = _mouth_rings(mesh, plan.mouth.loop(grid))
    mirror = np.array([mesh.mirror[vertex] for vertex in range(len(mesh.points))])
    return Topology(np.array(mesh.points), mirror, mesh.polygons, eyes, nostrils, mouth, neck_floor)


def _grid(mesh: Builder, plan: Layout, blocks: Sequence[Block]) -> npt.NDArray[np.int64]:
    """Add the grid's vertices and quads outside the blocks; returns vertex indices, -1 within a block."""
    rows = len(plan.rows)
    taken, open_quads = np.zeros((rows, COLUMNS), bool), np.zeros((rows, COLUMNS), bool)
    for block in blocks:
        columns = np.arange(block.first, block.last) % COLUMNS
        open_quads[block.top : block.bottom, columns] = True
        taken[block.top + 1 : block.bottom, columns[1:]] = True
    places = _cast_grid(plan)
    grid = np.full((rows, COLUMNS), -1, np.int64)
    for row, column in np.argwhere(~taken):
        grid[row, column] = mesh.add(places[row, column])
    for row, column in np.argwhere(~taken):
        mesh.mirror[int(grid[row, column])] = int(grid[row, -column % COLUMNS])
    for row, column in np.argwhere(~open_quads[:-1]):
        after = (column + 1) % COLUMNS
        corners = (grid[row, column], grid[row + 1, column], grid[row + 1, after], grid[row, after])
        mesh.polygons.append(tuple(int(vertex) for vertex in corners))
    return grid


def _cast_grid(plan: Layout) -> Array:
    """Return where the grid's rays meet the clay, (rows, columns, 3)."""
    row, column = (index.ravel() for index in np.indices((len(plan.rows), COLUMNS)))
    signed = np.where(column > HALF_COLUMNS, column - COLUMNS, column).astype(np.float64)
    y, z, slope_front, slope_back = plan.rows[row].T
    angle = column_angle(signed, y)
    slope = mix(slope_front, slope_back, (1 - np.cos(angle)) / 2)
    origins = np.column_stack([np.zeros_like(y), y, z])
    hits = clay.cast(origins, np.column_stack([np.sin(angle), slope, np.cos(angle)]))
    return hits.reshape(len(plan.rows), COLUMNS, 3)


def _close_ends(mesh: Builder, plan: Layout, grid: npt.NDArray[np.int64]) -> Loop:
    """Close the crown by one pole and the neck by a floor; returns the floor's vertices."""
    crown = mesh.add_on_midline(clay.cast(np.array([[0, 2.5, 1.0]]), np.array([[0, 1.0, 0]]))[0])
    mesh.fan([int(vertex) for vertex in grid[0]], crown, flipped=True)
    edge = [int(vertex) for vertex in grid[-1]]
    height = plan.rows[-1, 0] - 0.35
    outer, floor = edge, []
    for share in (0.93, 0.6):
        points = [mesh.points[vertex] for vertex in edge]
        inner = [mesh.add([p[0] * share, height, (p[2] + 1.5) * share - 1.5]) for p in points]
        for column in range(COLUMNS):
            mesh.mirror[inner[column]] = inner[-column % COLUMNS]
        mesh.band(outer, inner)
        floor += inner
        outer = inner
    floor.append(mesh.add_on_midline([0, height, -1.5]))
    mesh.fan(outer, floor[-1])
    return floor


def _paired_rings(mesh: Builder, border: Loop, count: int) -> dict[str, list[Loop]]:
    left = mesh.rings(border, count)
    right = mesh.rings([mesh.mirror[vertex] for vertex in border], count, flipped=True)
    for left_loop, right_loop in zip(left, right, strict=True):
        mesh.pair(left_loop, right_loop)
    return {"left": left, "right": right}


def _mouth_rings(mesh: Builder, border: Loop) -> list[Loop]:
    loops, count = mesh.rings(border, MOUTH_RINGS), len(border)
    for loop in loops[1:]:
        for place in range(count):
            mesh.mirror[loop[place]] = loop[(count // 2 - place) % count]
    back = mesh.add_on_midline()
    mesh.fan(loops[-1], back)
    return [*loops, [back]]
