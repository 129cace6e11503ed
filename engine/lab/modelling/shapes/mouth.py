"""Shapes of the lips: parted, rounded, pressed, rolled, shrugged. One-sided shapes are the left ones."""

from __future__ import annotations

import numpy as np

from engine.lab.modelling.lips import SLIT_Y
from engine.lab.modelling.sculpture import Sculpture
from engine.lab.modelling.shapes.fields import (
    Stroke,
    around,
    around_mouth,
    by_lip,
    by_ring,
    inner_lag,
    left_half,
    push_skin,
    strokes,
)
from engine.lab.modelling.solids import smooth_step
from engine.take import Array

CORNER = (2.5, SLIT_Y)
SIDEWAYS = (Stroke((0.0, SLIT_Y), (3.3, 2.0), (1.15, 0, 0), slides=True, crosses=True),)
CORNER_STROKES: dict[str, tuple[Stroke, ...]] = {
    "mouthSmile": (
        Stroke((2.35, SLIT_Y), (1.85, 1.7), (0.95, 0.80, -0.40), slides=True),
        Stroke((4.1, -3.9), (1.7, 1.4), (0.12, 0.52, 0.42)),
        Stroke((3.4, -1.9), (1.0, 1.2), (0, 0.12, 0.05)),
    ),
    "mouthFrown": (
        Stroke((2.4, SLIT_Y - 0.2), (1.35, 1.5), (0.10, -0.85, -0.05), slides=True),
        Stroke((2.6, -8.4), (1.6, 1.2), (0, -0.15, 0.18)),
    ),
    "mouthDimple": (
        Stroke(CORNER, (1.25, 1.3), (0.55, 0.12, -0.30), slides=True),
        Stroke((3.3, -6.1), (0.8, 0.9), (-0.05, 0, -0.30)),
    ),
    "mouthStretch": (
        Stroke((2.5, SLIT_Y - 0.2), (1.7, 1.8), (1.0, -0.30, -0.25), slides=True),
        Stroke((3.4, -9.0), (1.6, 2.2), (0.2, -0.15, 0.10)),
    ),
}


def mouth_pucker(head: Sculpture) -> Array:
    """Draw the corners in and push the lips forward."""
    points = head.skin
    pull = around_mouth(head, 2.9, 2.3) * inner_lag(head)
    height = points[:, 1] - SLIT_Y
    inward = np.column_stack([-0.46 * points[:, 0], -0.10 * height * (head.ring < 8), np.full(len(points), 0.30)])
    push = around_mouth(head, 2.2, 1.7) * inner_lag(head)
    return head.slide(head.move_skin(pull, inward), 0.75) + head.move_skin(push, (0, 0, 1.05))


def mouth_funnel(head: Sculpture) -> Array:
    """Round the lips and turn them outwards."""
    pull = around_mouth(head, 2.9, 2.3) * inner_lag(head)
    inward = head.slide(head.move_skin(pull, head.skin * [-0.30, 0, 0]), 0.75)
    flare = around_mouth(head, 2.0, 1.5) * inner_lag(head)
    apart = by_lip(head, 0.55, -0.62)
    return inward + head.move_skin(flare, np.column_stack([0 * apart, apart, np.full(len(apart), 0.80)]))


def mouth_press(head: Sculpture) -> Array:
    """Press one half of the lips together: the red thins and goes back."""
    thin = by_ring(head, {2: 0.35, 3: 0.7, 4: 1.0, 5: 1.0, 6: 1.0, 7: 1.0})
    height = np.where(head.ring >= 3, head.skin[:, 1] - SLIT_Y, 0.0)
    towards_slit = np.column_stack([0 * height, -0.38 * height, np.full(len(height), -0.16)])
    pressed = head.move_skin(thin * left_half(head), towards_slit)
    return pressed + strokes(head, Stroke(CORNER, (1.0, 1.0), (0.12, 0.05, -0.10), slides=True))


def mouth_roll_lower(head: Sculpture) -> Array:
    """Roll the lower lip in over the teeth."""
    amount = _roll(head) * np.clip(-head.lip, 0, 1)
    rise = np.where(head.ring >= 8, 0.06, 0.42)
    return head.move_skin(amount, np.column_stack([0 * rise, rise, np.full(len(rise), -0.58)]))


def mouth_roll_upper(head: Sculpture) -> Array:
    """Roll the upper lip in over the teeth."""
    amount = _roll(head) * np.clip(head.lip, 0, 1)
    drop = np.where(head.ring >= 8, -0.02, -0.26)
    return head.move_skin(amount, np.column_stack([0 * drop, drop, np.full(len(drop), -0.52)]))


def _roll(head: Sculpture) -> Array:
    rings = {2: 0.2, 3: 0.45, 4: 0.8, 5: 1.0, 6: 1.0, 7: 0.95, 8: 0.85, 9: 0.8, 10: 0.6}
    return by_ring(head, rings) * (1 - np.abs(head.along) ** 2.2)


def mouth_shrug_lower(head: Sculpture) -> Array:
    """Push chin and lower lip up, the lip a little out."""
    amount = head.smooth(around(head, (0, -7.7), (2.4, 2.2)) * by_lip(head, 0.0, 1.0), head.ring >= 7, 3)
    motion = push_skin(head, amount, (0, 0.52, 0.20))
    motion += strokes(head, Stroke((0, -9.2), (1.9, 1.5), (0, 0.24, 0.12), crosses=True))
    red = by_ring(head, dict.fromkeys(range(4, 11), 1.0)) * np.clip(-head.lip, 0, 1) * (1 - head.along**2)
    return motion + head.move_skin(red, (0, 0, 0.22))


def mouth_shrug_upper(head: Sculpture) -> Array:
    """Push the upper lip up and out."""
    amount = around(head, (0, -5.6), (2.4, 1.6)) * by_lip(head, 1.0, 0.0)
    return push_skin(head, head.smooth(amount, head.ring >= 7, 3), (0, 0.40, 0.22))


def mouth_upper_up(head: Sculpture) -> Array:
    """Raise one half of the upper lip and the cheek above it."""
    lifted = push_skin(head, _half_lip(head, by_lip(head, 1.0, 0.0)), (0.06, 0.70, 0.02), slides=True)
    return lifted + strokes(head, Stroke((2.2, -4.4), (1.2, 1.5), (0.08, 0.22, 0.12)))


def mouth_lower_down(head: Sculpture) -> Array:
    """Lower one half of the lower lip."""
    lowered = push_skin(head, _half_lip(head, by_lip(head, 0.0, 1.0)), (0.06, -0.72, -0.02), slides=True)
    return lowered + strokes(head, Stroke((1.6, -8.4), (1.4, 1.2), (0, -0.20, 0.06)))


def _half_lip(head: Sculpture, lip: Array) -> Array:
    """Return a field on the left half of one lip and the skin beside it, (skin,)."""
    on_rings = np.clip(1 - ((head.along - 0.42) / 0.62) ** 2, 0, 1)
    x, y = head.skin[:, 0], head.skin[:, 1]
    beside = np.exp(-(((x - 1.2) / 1.25) ** 2) - ((y - SLIT_Y) / 1.5) ** 2)
    amount = lip * np.where(head.ring >= 3, on_rings, beside) * head.front
    return head.smooth(amount, head.ring >= 3, 6)


def tongue_out(head: Sculpture) -> Array:
    """Put the tongue out between the lips, its tip lowest."""
    motion, part = head.still(), head.at["tongue"]
    eased = smooth_step(5.0, 9.0, head.points[part][:, 2])[:, None]
    motion[part] = eased * [0, 0.30, 4.2] + eased**2 * [0, -0.75, 0]
    return motion
