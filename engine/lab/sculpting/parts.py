"""Parts that are not skin: eyeballs, teeth, tongue, ears."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from engine.lab.modelling.solids import smooth_step
from engine.lab.sculpting import colours
from engine.lab.sculpting.clay import EYE_CENTRE, EYE_RADIUS
from engine.lab.sculpting.lips import outward
from engine.take import Array

# Where the upper teeth begin and end about the arch's middle: two broad incisors, a narrow one, a canine, two molars.
UPPER_DEGREES = (0.0, 16.5, 29.0, 41.0, 51.0, 60.0, 66.0)


@dataclass(frozen=True)
class Part:
    """One piece of mesh.

    Attributes
    ----------
    name : ends in `_left` where the part has a mirrored twin
    points : (n, 3), cm
    triangles : (triangles, 3)
    colours : (n, 3) sRGB, 0..1
    mirror : (n,) each vertex's mirror image within the part; None where the twin holds it
    """

    name: str
    points: Array
    triangles: npt.NDArray[np.int64]
    colours: Array
    mirror: npt.NDArray[np.int64] | None = None

    def twin(self) -> Part:
        """Return the mirrored part of the right side."""
        name = self.name.replace("_left", "_right")
        return Part(name, self.points * [-1, 1, 1], self.triangles[:, ::-1], self.colours)


def sheet(rows: int, columns: int, *, closed: bool = False) -> npt.NDArray[np.int64]:
    """Return the triangles of a grid of points, (triangles, 3); `closed` joins the last column to the first."""
    row, column = (index.ravel() for index in np.indices((rows - 1, columns if closed else columns - 1)))
    here, after = row * columns + column, row * columns + (column + 1) % columns
    quads = np.stack([here, here + columns, after + columns, after], axis=-1)
    return quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def sheet_mirror(rows: int, columns: int, *, closed: bool = False) -> npt.NDArray[np.int64]:
    """Return the mirror image of each point of a grid whose columns run from one side to the other, or round."""
    across = -np.arange(columns) % columns if closed else np.arange(columns)[::-1]
    return (np.arange(rows)[:, None] * columns + across).ravel()


def fan(loop: npt.NDArray[np.int64], centre: int) -> npt.NDArray[np.int64]:
    """Return the triangles that close a loop, (n, 3)."""
    return np.column_stack([np.full(len(loop), centre), loop, np.roll(loop, -1)])


def eyeball() -> Part:
    """Return the left eyeball, pupil and iris in its colours."""
    angles, columns = np.array([2.5, 5, 9, 10.5, 13, 18, 22.5, 24.5, 26.5, 32, 42, 56, 74, 96]), 28
    angle, turn = np.meshgrid(np.radians(angles), 2 * np.pi * np.arange(columns) / columns, indexing="ij")
    ball = np.stack([np.sin(angle) * np.cos(turn), np.sin(angle) * np.sin(turn), np.cos(angle)], axis=-1)
    points = np.concatenate(
        [EYE_CENTRE + EYE_RADIUS * ball.reshape(-1, 3), EYE_CENTRE[None] + np.array([0, 0, EYE_RADIUS])]
    )
    degrees, turn = np.degrees(angle).reshape(-1, 1), turn.reshape(-1, 1)
    iris = np.array(colours.IRIS) * (0.9 + 0.1 * np.sin(9 * turn)) * (1 - 0.35 * (degrees > 21))
    white = np.array(colours.WHITE) * (1 - 0.28 * smooth_step(30, 74, degrees))  # in the lids' shade
    paint = np.where(degrees < 9.5, colours.PUPIL, np.where(degrees < 23.5, iris, white))
    triangles = np.concatenate(
        [sheet(len(angles), columns, closed=True), fan(np.arange(columns), centre=len(points) - 1)]
    )
    return Part("eye_left", points, triangles, np.concatenate([paint, [colours.PUPIL]]))


def teeth(contact: Array, *, upper: bool) -> Part:
    """Return a row of twelve teeth with gums, behind the lips' contact line, (n, 3) from right to left."""
    columns, middle_y = 61, contact[len(contact) // 2, 1]
    arch, away = _upper_arch(contact, columns) if upper else _lower_arch(contact, columns)
    tooth = np.abs(np.sin(np.pi * np.arange(columns) / 5))[:, None] ** 0.35  # five columns each
    sign, edge = (1.0, -0.22) if upper else (-1.0, -0.03)
    # height above the edge, how far forward, whether it is gum
    profile = ((1.25, -0.02, 1), (0.95, 0.0, 1), (0.80, 0.02, 0), (0.35, 0.05, 0), (0.06, 0.03, 0), (0.0, -0.06, 0))
    points, paint = [], []
    for height, forward, is_gum in (*profile, (0.30, -0.22, 0)):
        row = arch + away * (forward * (0.6 + 0.4 * tooth))
        row[:, 1] = middle_y + edge + sign * height
        points.append(row)
        tint = np.array(colours.TOOTH) * (0.72 + 0.28 * tooth)
        paint.append(np.tile(colours.GUM, (columns, 1)) if is_gum else tint)
    rows = len(points)
    triangles = sheet(rows, columns) if upper else sheet(rows, columns)[:, ::-1]
    name = "teeth_upper" if upper else "teeth_lower"
    return Part(name, np.concatenate(points), triangles, np.concatenate(paint), sheet_mirror(rows, columns))


def _upper_arch(contact: Array, columns: int) -> tuple[Array, Array]:
    """Return the upper teeth's line and the way out of it, (columns, 3) each: half an ellipse, on as far as a smile shows."""
    wide, deep, front = 2.5, 3.6, contact[len(contact) // 2, 2] - 0.86
    turn = np.radians(np.interp(np.linspace(-1, 1, columns), np.linspace(-1, 1, 13), _mirrored(UPPER_DEGREES)))
    line = np.column_stack([wide * np.sin(turn), np.zeros(columns), front - deep * (1 - np.cos(turn))])
    away = np.column_stack([deep * np.sin(turn), np.zeros(columns), wide * np.cos(turn)])
    return line, away / np.linalg.norm(away, axis=1, keepdims=True)


def _lower_arch(contact: Array, columns: int) -> tuple[Array, Array]:
    """Return the lower teeth's line and the way out of it, (columns, 3) each, along the lips' contact."""
    away = outward(contact)
    line = contact - away * 0.98
    place, along = np.linspace(0, 1, len(line)), np.linspace(0.03, 0.97, columns)
    there = [np.column_stack([np.interp(along, place, one[:, axis]) for axis in range(3)]) for one in (line, away)]
    return there[0], there[1]


def _mirrored(half: tuple[float, ...]) -> Array:
    """Return angles from the middle outwards as angles from right to left."""
    return np.array([*(-angle for angle in half[:0:-1]), *half])


def tongue() -> Part:
    """Return the tongue, a flattened tube with a groove."""
    rows, columns = 11, 20
    along = np.linspace(0, 1, rows)[:, None]
    turn = 2 * np.pi * np.arange(columns) / columns
    width = 1.55 * np.sqrt(np.maximum(1e-4, 1 - np.maximum(0, (along - 0.55) / 0.45) ** 2.2))
    height = 0.62 * (1 - 0.45 * along)
    width[-1], height[-1] = 0.05, 0.02
    x, y = width * np.sin(turn), height * np.cos(turn)
    y = y - 0.16 * np.exp(-((x / 0.25) ** 2)) * (y > 1e-9) - 8.25 + 0.35 * np.sin(along * 2.6)
    tube = np.stack([x, y, np.broadcast_to(5.3 + 4.4 * along, x.shape)], axis=-1).reshape(-1, 3)
    points = np.concatenate([tube, [[0, -8.25 + 0.35 * np.sin(2.6), 9.75]]])
    tip, last = len(tube), (rows - 1) * columns + np.arange(columns)
    triangles = np.concatenate([sheet(rows, columns, closed=True), fan(last, tip)[:, [1, 0, 2]]])
    mirror = np.append(sheet_mirror(rows, columns, closed=True), tip)
    paint = np.array(colours.TONGUE) * np.append(np.repeat(0.5 + 0.5 * along[:, 0] ** 0.7, columns), 1.0)[:, None]
    return Part("tongue", points, triangles, paint, mirror)


def ear() -> Part:
    """Return the left ear: a tilted oval with helix, antihelix, concha, tragus and lobe, and a back to it."""
    rows, columns = 12, 36
    out, turn = np.meshgrid(
        np.linspace(0.06, 1, rows), 2 * np.pi * np.arange(columns) / columns, indexing="ij"
    )  # from the middle outwards; round, from the back over the top
    relief, lift, shadow, (across, above) = _ear_relief(out, turn)
    tilt = np.radians(-14)
    origin = np.array([7.75, -1.3, -0.6])
    y = above * np.cos(tilt) + across * np.sin(tilt) * 0.9
    z = above * np.sin(tilt) * 0.9 - across * np.cos(tilt)
    behind = np.minimum(lift * 0.75 - 0.30 - 0.25 * (1 - out), relief - 0.12)
    front = (origin + np.stack([relief, y, z], axis=-1)).reshape(-1, 3)
    back = (origin + np.stack([behind, y * 0.985, z * 0.985], axis=-1)).reshape(-1, 3)
    points = np.concatenate([front, back, [front[:columns].mean(axis=0), back[:columns].mean(axis=0)]])
    tone = np.concatenate([shadow.ravel(), np.full(len(back), 0.92)])[:, None]
    paint = np.array(colours.SKIN) * tone * [1.0, 0.98, 0.97]
    paint = np.concatenate([paint, paint[:1], paint[len(front) : len(front) + 1]])
    return Part("ear_left", points, _ear_triangles(rows, columns), paint)


def _ear_relief(out: Array, turn: Array) -> tuple[Array, Array, Array, tuple[Array, Array]]:
    """Return how far the ear stands out, how far its plane does, its shading, and places across and above its middle."""
    back, up = np.cos(turn), np.sin(turn)
    half_width = 1.42 + 0.22 * np.maximum(up, 0) - 0.35 * np.maximum(-up, 0) ** 1.5
    across, above = out * half_width * back, out * np.where(up > 0, 2.75, 2.85) * up
    helix = 0.30 * np.exp(-(((out - 0.88) / 0.10) ** 2)) * np.clip(0.35 + 0.9 * back + 0.55 * up, 0, 1)
    antihelix = 0.24 * np.exp(-(((out - 0.62) / 0.10) ** 2)) * np.clip(back * 0.9 + 0.35, 0, 1) * (up > -0.75)
    concha = np.exp(-((across + 0.15) ** 2 / 0.55 + (above + 0.35) ** 2 / 1.1))
    tragus = 0.30 * np.exp(-((across + 1.0) ** 2 / 0.10 + (above + 0.55) ** 2 / 0.30))
    lift = 0.95 * np.clip((across + 1.5) / 3.0, 0, 1.2) ** 1.1  # stands off the skull towards the back
    relief = lift + helix + antihelix - 0.55 * concha * (1 - out**4) + tragus - 0.25 * np.clip(-up, 0, 1) * out
    return relief, lift, 1 - 0.25 * np.clip(0.77 * concha, 0, 1), (across, above)


def _ear_triangles(rows: int, columns: int) -> npt.NDArray[np.int64]:
    count, face = rows * columns, sheet(rows, columns, closed=True)
    inner = np.arange(columns)
    outer = inner + (rows - 1) * columns
    after = np.roll(outer, -1)
    rim = np.concatenate(
        [np.column_stack([outer, outer + count, after + count]), np.column_stack([outer, after + count, after])]
    )
    hubs = [fan(inner, 2 * count), fan(inner + count, 2 * count + 1)[:, [0, 2, 1]]]
    return np.concatenate([face, face[:, ::-1] + count, rim, *hubs])[:, ::-1]
