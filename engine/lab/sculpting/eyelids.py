"""The lids: rings that rotate about the eyeball, so that a blink closes exactly."""

from __future__ import annotations

import numpy as np

from engine.lab.modelling.solids import mix, turn_y, turn_z
from engine.lab.sculpting.clay import EYE_CENTRE, EYE_RADIUS
from engine.take import Array

POINTS = 36  # of a ring: 0 at the medial corner, over the upper lid to 18 at the lateral one, back below
SKIN_RINGS = 4  # rings of the eye block outside the lids' own
HALF_WIDTH_DEGREES = 68.0
_LID_FRAME = turn_y(6.0) @ turn_z(4.0)  # columns: the left lid's own x, y, z


def on_eyeball(azimuth: Array, elevation: Array, radius: Array) -> Array:
    """Return points about the left eye, (n, 3), from angles in degrees and distances from its centre."""
    across, above = np.radians(azimuth), np.radians(elevation)
    level = np.cos(across)
    local = np.stack([np.sin(across), level * np.sin(above), level * np.cos(above)], axis=-1)
    return np.asarray(EYE_CENTRE + (radius[:, None] * local) @ _LID_FRAME.T)


def positions() -> tuple[Array, Array]:
    """Return each ring point's place along the slit, -1..1, and its lid: +1 upper, -1 lower, 0 at a corner."""
    k = np.arange(POINTS)
    half = POINTS // 2
    share = np.where(k <= half, k / half, (POINTS - k) / half)
    even = 2 * share - 1
    along = 0.75 * even + 0.25 * np.sin(even * np.pi / 2)
    lid = np.where((k == 0) | (k == half), 0, np.where(k < half, 1, -1))
    return along, lid.astype(np.float64)


def open_elevation(along: Array, lid: Array) -> Array:
    """Return the elevation of the open margin in degrees."""
    upper = 18.5 * (1 - np.abs(along) ** 2.6) ** 0.8 * (1 - 0.10 * along)
    lower = -20.5 * (1 - np.abs(along) ** 2.4) ** 0.85 * (1 + 0.10 * along)
    return np.where(lid > 0, upper, np.where(lid < 0, lower, 0.0))


def margin_elevation(along: Array, lid: Array, closed: float, raise_upper: float, raise_lower: float) -> Array:
    """Return the elevation of the margin in degrees, `closed` 0..1 of the way to the closed slit."""
    raised = np.where(lid > 0, raise_upper, np.where(lid < 0, raise_lower, 0.0)) * (1 - np.abs(along) ** 3)
    return mix(open_elevation(along, lid) + raised, -11.0 * (1 - np.abs(along) ** 2.4), closed)


def rings(closed: float = 0.0, raise_upper: float = 0.0, raise_lower: float = 0.0) -> Array:
    """Return the left lids' rings, (8, 36, 3).

    In order: fold, crease, two of the plate, outer margin, inner margin, and two hidden ones under the lid.
    `closed` is 0..1; the raises are degrees. Fold and crease follow the margin less.
    """
    along, lid = positions()
    opened = open_elevation(along, lid)
    margin = margin_elevation(along, lid, closed, raise_upper, raise_lower)
    middle = 1 - np.abs(along) ** 6
    outward = np.sign(along) * np.abs(along) ** 6
    corner = np.abs(along) ** 4
    crease = opened + np.where(lid > 0, 12.5 - 3.0 * along**2, np.where(lid < 0, -16.0, 0)) * middle
    fold = opened + np.where(lid > 0, 14.0 - 2.5 * along**2, np.where(lid < 0, -24.0, 0)) * middle
    crease = crease + (margin - opened) * np.where(lid > 0, 0.28, 0.25)
    fold = fold + (margin - opened) * np.where(lid > 0, 0.12, 0.2)
    base = EYE_RADIUS + 0.10 * corner + 0.05 * closed
    fold_height = np.where(lid >= 0, 0.40, 0.27) * (1 - corner) + 0.27 * corner

    def ring(widening: float, elevation: Array, height: Array | float) -> Array:
        azimuth = HALF_WIDTH_DEGREES * along + widening * outward
        return on_eyeball(azimuth, elevation, base + height)

    return np.array(
        [
            ring(9.0, fold, fold_height),
            ring(6.5, crease, np.where(lid >= 0, 0.20, 0.22)),
            ring(4.5, mix(margin, crease, 0.62), 0.23),
            ring(2.5, mix(margin, crease, 0.25), 0.22),
            ring(0.8, margin + lid * 0.8 * middle, 0.165),
            ring(0.0, margin, 0.045),
            ring(2.0, margin + lid * 5 * middle, 0.05),
            ring(10.0, margin + lid * 16 * middle, 0.09),
        ]
    )
