"""Brows: strips that lie on the clay."""

from __future__ import annotations

import numpy as np

from engine.modelling import clay, colours
from engine.modelling.parts import Part, sheet


def brow() -> Part:
    """Return the left brow."""
    columns = 18
    t = np.linspace(0, 1, columns)
    x = 1.25 + 3.75 * t
    y = 1.55 + 0.62 * np.sin(np.pi * (t * 0.86 + 0.02)) ** 1.1 - 0.25 * t**3
    width = 0.34 * (1 - t) ** 0.45 * (0.45 + 0.55 * np.minimum(1, t / 0.15)) + 0.05
    rows = []
    for across, height in ((-1.0, 0.012), (-0.35, 0.085), (0.35, 0.085), (1.0, 0.012)):
        on_clay = clay.cast_forward(x, y + across * width)
        rows.append(on_clay + clay.normals(on_clay) * height)
    points = np.concatenate(rows)
    return Part("brow_left", points, sheet(len(rows), columns), np.tile(colours.BROW, (len(points), 1)))
