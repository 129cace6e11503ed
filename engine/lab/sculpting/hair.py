"""Brows, lashes and hair."""

from __future__ import annotations

import numpy as np

from engine.lab.modelling.solids import mix, smooth_step
from engine.lab.sculpting import clay, colours, eyelids
from engine.lab.sculpting.hairline import CAP_CENTRE, HAIRLINE
from engine.lab.sculpting.parts import Part, fan, sheet, sheet_mirror
from engine.take import Array

LASH_COLUMNS = 45
CAP_ROWS, CAP_COLUMNS = 20, 96
_WHORL = np.array([0.0, 0.88, -0.475])  # where the hair grows from, at the back of the crown


def brow() -> Part:
    """Return the left brow, a low ridge on the clay that thins out at both ends."""
    columns = 26
    t = np.linspace(0, 1, columns)
    x = 1.15 + 3.95 * t
    y = 1.55 + 0.62 * np.sin(np.pi * (t * 0.86 + 0.02)) ** 1.1 - 0.25 * t**3
    width = 0.33 * (1 - t) ** 0.6 * smooth_step(-0.12, 0.30, t) + 0.012
    rows = []
    for across, height in ((-1.0, -0.02), (-0.5, 0.25), (0.5, 0.25), (1.0, -0.02)):
        on_clay = clay.cast_forward(x - 0.08 * across * (1 - t), y + across * width)
        rows.append(on_clay + clay.normals(on_clay) * (height * width)[:, None])
    points = np.concatenate(rows)
    return Part("brow_left", points, sheet(len(rows), columns), np.tile(colours.BROW, (len(points), 1)))


def lash_points(closed: float = 0.0, raise_upper: float = 0.0, raise_lower: float = 0.0) -> Array:
    """Return the left upper lashes' points, (5 x 45, 3), for lids posed as by `eyelids.rings`.

    Rows run from the root above along the top to the tips, and back underneath.
    """
    along = np.linspace(-0.95, 0.97, LASH_COLUMNS)
    margin = eyelids.margin_elevation(along, np.ones(LASH_COLUMNS), closed, raise_upper, raise_lower)
    clump = np.where(np.arange(LASH_COLUMNS) % 2, 1.0, 0.84)
    length = 0.25 * (1 - np.abs(along) ** 4) * (0.62 + 0.38 * along) * clump
    curl = float(mix(9.0, -4.0, closed)) * length / 0.25
    root = clay.EYE_RADIUS + 0.10 * np.abs(along) ** 4 + 0.05 * closed
    flare = eyelids.HALF_WIDTH_DEGREES * along
    rows = [
        eyelids.on_eyeball(flare, margin + 1.8 * (1 - np.abs(along) ** 6), root + 0.19),
        eyelids.on_eyeball(flare + 2 * along, margin + 0.9 + 0.35 * curl, root + 0.19 + 0.6 * length),
        eyelids.on_eyeball(flare + 6 * along, margin + 0.4 + curl, root + 0.17 + length),
        eyelids.on_eyeball(flare + 2 * along, margin - 0.4 + 0.35 * curl, root + 0.15 + 0.6 * length),
        eyelids.on_eyeball(flare, margin, root + 0.06),
    ]
    return np.concatenate(rows)


def lashes() -> Part:
    """Return the left upper lashes."""
    points = lash_points()
    return Part("lashes_left", points, sheet(5, LASH_COLUMNS), np.tile(colours.LASH, (len(points), 1)))


def cap() -> Part:
    """Return the hair: a shell over the scalp whose border is the hairline, in locks that grow from the whorl."""
    degrees = 360.0 * np.arange(CAP_COLUMNS) / CAP_COLUMNS
    share = np.linspace(0, 1, CAP_ROWS + 1)[:-1] ** 1.6  # of the way from hairline to whorl
    rim = _rim_directions(degrees)
    ways = mix(rim, _WHORL, share[:, None, None])
    top = smooth_step(-0.2, 0.9, (ways / np.linalg.norm(ways, axis=-1, keepdims=True))[..., 1])
    locks, grain = _locks(), _grain()
    rise = np.sqrt(np.clip(share[:, None] / mix(0.45, 0.16, top), 0, 1))  # cut short at sides and nape
    height = rise * (mix(0.13, 0.36, top) + 0.04 * locks * (1 - share[:, None]) + 0.03 * grain)
    height[0] = -0.05  # the border dips into the scalp
    scalp = clay.cast(np.tile(CAP_CENTRE, (ways.size // 3, 1)), ways.reshape(-1, 3))
    points = scalp + clay.normals(scalp) * height.reshape(-1, 1)
    whorl = clay.cast(CAP_CENTRE[None], _WHORL[None])
    points = np.concatenate([points, whorl + clay.normals(whorl) * 0.37])
    tint = (1 + 0.10 * locks * (1 - share[:, None] ** 2) + 0.16 * grain).reshape(-1, 1)
    paint = np.concatenate([np.array(colours.HAIR) * tint, [colours.HAIR]])
    last = (CAP_ROWS - 1) * CAP_COLUMNS + np.arange(CAP_COLUMNS)
    triangles = np.concatenate([sheet(CAP_ROWS, CAP_COLUMNS, closed=True)[:, ::-1], fan(last, len(points) - 1)])
    mirror = np.append(sheet_mirror(CAP_ROWS, CAP_COLUMNS, closed=True), len(points) - 1)
    return Part("hair", points, triangles, paint, mirror)


def _locks() -> Array:
    """Return how far each column's lock stands out, about -1..1, the same on both sides, (columns,)."""
    half = np.random.default_rng(5).uniform(-1, 1, CAP_COLUMNS // 2 + 1)
    return np.concatenate([half, half[-2:0:-1]])


def _grain() -> Array:
    """Return how far single tufts stand out, about -1..1, the same on both sides, (rows, columns)."""
    half = np.random.default_rng(6).uniform(-1, 1, (CAP_ROWS, CAP_COLUMNS // 2 + 1))
    return np.concatenate([half, half[:, -2:0:-1]], axis=1)


def _rim_directions(degrees: Array) -> Array:
    """Return the directions from the cap's centre to the hairline, found by bisection, (columns, 3)."""
    height = HAIRLINE(np.minimum(degrees, 360 - degrees))
    turn = np.radians(degrees)
    low, high = np.full(len(turn), -1.1), np.full(len(turn), 1.4)
    for _ in range(16):
        middle = 0.5 * (low + high)
        level = np.cos(middle)
        ways = np.column_stack([level * np.sin(turn), np.sin(middle), level * np.cos(turn)])
        hits = clay.cast(np.tile(CAP_CENTRE, (len(turn), 1)), ways)
        low, high = np.where(hits[:, 1] < height, middle, low), np.where(hits[:, 1] < height, high, middle)
    return ways
