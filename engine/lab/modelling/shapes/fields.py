"""What the shapes are made of: soft fields over the face, and strokes that push it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from engine.lab.modelling.lips import SLIT_Y
from engine.lab.modelling.sculpture import Sculpture
from engine.lab.modelling.solids import smooth_step
from engine.take import Array

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Stroke:
    """A push of the skin round one place of the face, fading as a Gaussian in x and y.

    `place` and `spread` are (x, y) in cm, `move` is (x, y, z) in cm; a stroke is kept to the left half unless it
    `crosses` the middle, and `slides` round the face where it would otherwise cut through it.
    """

    place: tuple[float, float]
    spread: tuple[float, float]
    move: Vector
    slides: bool = False
    crosses: bool = False


def strokes(head: Sculpture, *pushes: Stroke) -> Array:
    """Return the motion of several strokes together, (n, 3)."""
    motion = head.still()
    for push in pushes:
        amount = around(head, push.place, push.spread) * (1.0 if push.crosses else left_half(head))
        motion += push_skin(head, amount, push.move, slides=push.slides)
    return motion


def push_skin(head: Sculpture, amount: Array, move: npt.ArrayLike, *, slides: bool = False) -> Array:
    """Return the motion of the skin by amount, (skin,); lids and the inner side of the lips follow less."""
    motion = head.move_skin(amount * inner_lag(head) * head.followers, move)
    return head.slide(motion) if slides else motion


def around(head: Sculpture, place: tuple[float, float], spread: tuple[float, float]) -> Array:
    """Return a Gaussian in x and y on the front of the face, (skin,)."""
    x, y = (head.skin[:, axis] - place[axis] for axis in (0, 1))
    return np.asarray(np.exp(-((x / spread[0]) ** 2) - (y / spread[1]) ** 2) * head.front)


def around_mouth(head: Sculpture, across: float, above: float) -> Array:
    """Return a Gaussian about the middle of the mouth."""
    return around(head, (0.0, SLIT_Y), (across, above))


def left_half(head: Sculpture) -> Array:
    """Return 1 on the character's left, 0 on the right, with a soft seam in the middle."""
    return smooth_step(-0.7, 0.7, head.skin[:, 0])


def inner_lag(head: Sculpture) -> Array:
    """Return how far the rings of the mouth follow its outside: the inner side less."""
    return np.where(head.ring >= 12, 0.25, np.where(head.ring >= 10, 0.7, 1.0))


def by_ring(head: Sculpture, values: dict[int, float]) -> Array:
    """Return a value by ring of the mouth, 0 for rings not named and for the rest of the skin, (skin,)."""
    table = np.zeros(18)
    for ring, value in values.items():
        table[ring + 1] = value
    return table[head.ring + 1]


def by_lip(head: Sculpture, upper: float, lower: float) -> Array:
    """Return one value above the slit and one below, their mean at the corners, (skin,)."""
    above = np.where(head.skin[:, 1] > SLIT_Y, upper, lower)
    on_rings = np.where(head.lip > 0, upper, np.where(head.lip < 0, lower, 0.5 * (upper + lower)))
    return np.where(head.ring >= 0, on_rings, above)
