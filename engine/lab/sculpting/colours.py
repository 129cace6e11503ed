"""The head's paint: one sRGB colour per vertex, 0..1."""

from __future__ import annotations

import numpy as np

from engine.lab.modelling.solids import bell
from engine.lab.sculpting import hairline, lips
from engine.lab.sculpting.topology import Topology
from engine.take import Array

SKIN, LIP, INNER = (0.86, 0.68, 0.58), (0.77, 0.50, 0.46), (0.40, 0.15, 0.15)
BROW, LASH, HAIR = (0.34, 0.24, 0.19), (0.12, 0.08, 0.07), (0.36, 0.25, 0.18)
WHITE, IRIS, PUPIL = (0.93, 0.92, 0.90), (0.28, 0.45, 0.50), (0.03, 0.03, 0.04)
TOOTH, GUM, TONGUE = (0.93, 0.91, 0.85), (0.72, 0.38, 0.38), (0.74, 0.38, 0.38)


def skin_colours(topology: Topology) -> Array:
    """Return the skin's colours, (n, 3): blush, lips, lids' margins, the dark of nostrils and mouth."""
    points = topology.points
    paint: Array = np.tile(SKIN, (len(points), 1)) * (1 - 0.10 * _blush(points)[:, None] * np.array([0.2, 1, 1]))
    paint = paint * (1 - 0.03 * bell(points, (0, -8.8, 8), (4.5, 3, 5))[:, None])  # shadow of a beard
    grown = 0.9 * hairline.hair_share(points)[:, None]
    paint = paint * (1 - grown) + 0.85 * np.array(HAIR) * grown
    _paint_lips(paint, topology)
    for side in ("left", "right"):
        lids, nostril = topology.eyes[side], topology.nostrils[side]
        for ring in (8, 9):
            paint[lids[ring]] *= [0.72, 0.62, 0.62]
        for ring in (10, 11):
            paint[lids[ring]] = np.array(SKIN) * [0.85, 0.62, 0.6]
        for ring in (2, 3, 4):
            paint[nostril[ring]] = np.array(SKIN) * [0.45, 0.35, 0.33]
    return paint


def _blush(points: Array) -> Array:
    cheeks = bell(points, (3.6, -3.6, 7.5), (2, 1.8, 3)) + bell(points, (-3.6, -3.6, 7.5), (2, 1.8, 3))
    return cheeks + 0.7 * bell(points, (0, -3.2, 11), (1.2, 1, 1.5))


def _paint_lips(paint: Array, topology: Topology) -> None:
    along = lips.positions()[0]
    for ring, strength in ((4, 0.55), (5, 1.0), (6, 1.0), (7, 1.0), (8, 1.0), (9, 1.0)):
        loop = topology.mouth[ring]
        share = (strength * (1 - 0.25 * np.abs(along) ** 6))[:, None]
        paint[loop] = paint[loop] * (1 - share) + np.array(LIP) * share
    for loop in topology.mouth[10:]:
        paint[loop] = INNER
