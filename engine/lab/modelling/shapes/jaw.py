"""Shapes of the jaw: one rigid motion, shared out to the skin by weight."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from engine.lab.modelling.lips import SLIT_Y
from engine.lab.modelling.sculpture import Sculpture
from engine.lab.modelling.shapes.fields import by_ring
from engine.lab.modelling.solids import turn_x
from engine.take import Array

HINGE = np.array([0.0, -1.3, 0.6])
OPEN_DEGREES = 24.5


def jaw_open(head: Sculpture) -> Array:
    """Turn about the hinge, which glides forward a little."""
    turn = turn_x(OPEN_DEGREES)
    return _rigid(head, lambda points: (points - HINGE) @ turn.T + HINGE - points + [0, 0, 0.25])


def jaw_forward(head: Sculpture) -> Array:
    """Push the lower teeth before the upper."""
    return _rigid(head, lambda points: np.tile([0, 0, 0.75], (len(points), 1)))


def jaw_left(head: Sculpture) -> Array:
    """Shift to the character's left, swinging about the left hinge."""
    return _rigid(
        head, lambda points: np.stack([np.full(len(points), 1.45), 0 * points[:, 0], -0.09 * points[:, 0]], axis=-1)
    )


def mouth_close(head: Sculpture) -> Array:
    """Let the lips meet while the jaw stays down.

    Defined as minus the jaw's motion on the lips plus one travel common to both, so that lips that touch keep touching
    at every angle of the jaw.
    """
    x, y = head.skin[:, 0], head.skin[:, 1]
    jaw = jaw_open(head)[: len(x)]
    lips = dict.fromkeys(range(4, 10), 1.0)
    on_rings = by_ring(
        head, {0: 0.36, 1: 0.5, 2: 0.68, 3: 0.86, **lips, 10: 0.95, 11: 0.8, 12: 0.45, 13: 0.15, 14: 0.15, 15: 0.15}
    )
    around = 0.6 * np.exp(-((x / 2.9) ** 2 + ((y - SLIT_Y) / 2.6) ** 2)) * head.front
    share = head.smooth(np.where(head.ring >= 0, on_rings, np.minimum(around, 0.36)), head.ring >= 2, 8)
    lower_lip = head.topology.mouth[8][36]
    travel = jaw[lower_lip] * 0.42 * [0, 1, 0.6]
    fading = np.where(head.ring >= 4, 1 - 0.55 * np.abs(head.along) ** 2.5, np.exp(-((x / 2.6) ** 2)))
    return head.move_skin(share, fading[:, None] * travel - jaw)


def _rigid(head: Sculpture, move: Callable[[Array], Array]) -> Array:
    """Apply a motion of points, (n, 3) to (n, 3), to the skin by weight, and to lower teeth and tongue."""
    motion = head.move_skin(head.jaw, move(head.skin))
    for part, share in (("teeth_lower", 1.0), ("tongue", 0.92)):
        motion[head.at[part]] = share * move(head.points[head.at[part]])
    return motion
