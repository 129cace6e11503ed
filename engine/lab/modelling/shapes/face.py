"""Shapes of cheeks, nose and brows. One-sided shapes are the left ones."""

from __future__ import annotations

import numpy as np

from engine.lab.modelling.sculpture import Sculpture, stay_off_clay
from engine.lab.modelling.shapes.eyes import move_lids
from engine.lab.modelling.shapes.fields import Stroke, Vector, around, around_mouth, inner_lag, left_half, strokes
from engine.lab.modelling.solids import smooth_step
from engine.take import Array

_BROWS = ("brow_left", "brow_right")


def cheek_puff(head: Sculpture) -> Array:
    """Blow up both cheeks, the lips a little."""
    amount = around(head, (4.0, -5.6), (2.3, 2.1)) * left_half(head) * np.where(head.ring >= 9, 0.3, 1.0)
    lips = around_mouth(head, 2.2, 1.4) * inner_lag(head)
    left = head.move_skin(amount, head.normal) + head.move_skin(lips, (0, 0, 0.12))
    return left + head.flip(left)


def cheek_squint(head: Sculpture) -> Array:
    """Raise the cheek and with it the lower lid."""
    cheek = strokes(
        head, Stroke((3.6, -2.7), (1.7, 1.2), (0.05, 0.70, 0.42)), Stroke((3.5, -1.5), (1.6, 0.6), (0, 0.15, 0.12))
    )
    return cheek + move_lids(head, raise_upper=-1.5, raise_lower=8.0)


def nose_sneer(head: Sculpture) -> Array:
    """Raise the wing of the nose and the lip below it, and wrinkle the bridge."""
    return strokes(
        head,
        Stroke((1.25, -3.3), (0.95, 1.1), (0.10, 0.55, 0.05)),
        Stroke((1.6, -4.9), (1.1, 0.9), (0.05, 0.38, 0.10)),
        Stroke((0.9, -0.9), (0.7, 1.0), (0, 0.18, 0.10)),
        Stroke((1.1, 1.2), (0.9, 0.7), (-0.05, -0.18, 0.05)),
    )


def brow_down(head: Sculpture) -> Array:
    """Draw the brow down and in, with a fold between the brows."""
    lowered = _on_skull(head, _brow(head, (2.3, 1.7), (1.7, 1.0, 1.8), (-0.28, -0.62, 0.0)))
    return lowered + _brow(head, (1.0, 1.5), (0.8, 0.8, 1.2), (-0.10, -0.10, 0.12))


def brow_inner_up(head: Sculpture) -> Array:
    """Raise the inner ends of both brows."""
    left = _on_skull(head, _brow(head, (1.2, 1.8), (1.5, 1.1, 2.8), (0.05, 0.95, 0)))
    return left + head.flip(left)


def brow_outer_up(head: Sculpture) -> Array:
    """Raise the outer end of the brow."""
    return _on_skull(head, _brow(head, (4.2, 1.9), (1.7, 1.1, 2.6), (0, 0.95, 0)))


def _brow(head: Sculpture, place: tuple[float, float], spread: Vector, move: Vector) -> Array:
    """Push forehead and brows round a place, `spread` across, below and above it."""
    x, y, z = head.points.T
    across, below, above = spread
    height = np.where(y > place[1], above, below)
    amount = np.exp(-(((x - place[0]) / across) ** 2) - ((y - place[1]) / height) ** 2) * smooth_step(2.0, 5.5, z)
    motion = head.move_skin(amount[: len(head.skin)] * head.followers, move)
    for part in _BROWS:
        motion[head.at[part]] = amount[head.at[part]][:, None] * np.asarray(move)
    return motion


def _on_skull(head: Sculpture, motion: Array) -> Array:
    """Keep forehead and brows at their distance from the skull."""
    slid = head.slide(motion)
    for part in _BROWS:
        where = head.at[part]
        slid[where] += stay_off_clay(head.points[where], motion[where])
    return slid
