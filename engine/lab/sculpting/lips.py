"""The lips' profile, and the bag of the mouth behind them, as rings."""

from __future__ import annotations

import numpy as np

from engine.lab.modelling.solids import mix
from engine.lab.sculpting import clay
from engine.take import Array

POINTS = 48  # of a ring: 0 at the right corner, over the upper lip to 24 at the left one, back below
SKIN_RINGS = 4  # rings of the mouth block outside the lips' own
SLIT_Y = -7.07
HALF_WIDTH = 2.46
ARCH_CENTRE_Z = 7.7  # of the cylinder that lips and teeth follow


def positions() -> tuple[Array, Array]:
    """Return each ring point's place along the lips, -1..1, and its lip: +1 upper, -1 lower, 0 at a corner."""
    k = np.arange(POINTS)
    half = POINTS // 2
    share = np.where(k <= half, k / half, (POINTS - k) / half)
    along = 0.55 * (-np.cos(np.pi * share)) + 0.45 * (2 * share - 1)
    lip = np.where((k == 0) | (k == half), 0, np.where(k < half, 1, -1))
    return along, lip.astype(np.float64)


def curves(along: Array) -> tuple[Array, Array, Array]:
    """Return the heights of the slit and of the upper and lower borders, cm."""
    a = np.abs(along)
    slit = SLIT_Y + 0.05 * np.exp(-(((a - 0.48) / 0.2) ** 2)) - 0.05 * np.exp(-((a / 0.2) ** 2)) - 0.02 * a**3
    bow = 0.08 * np.exp(-(((a - 0.22) / 0.12) ** 2)) - 0.08 * np.exp(-((a / 0.13) ** 2))
    upper = slit + 0.78 * (1 - a**1.9) + bow
    lower = slit - 0.98 * (1 - a**2.3) ** 0.85
    return slit, upper, lower


def outward(points: Array) -> Array:
    """Return the horizontal direction away from the dental arch's axis, unit (n, 3)."""
    direction = np.stack([points[:, 0], np.zeros(len(points)), points[:, 2] - ARCH_CENTRE_Z], axis=-1)
    return np.asarray(direction / np.linalg.norm(direction, axis=-1, keepdims=True))


def rings() -> list[Array]:
    """Return the rings' points from the lips' border inwards, eleven of (48, 3), then the back of the mouth, (1, 3)."""
    visible = _visible_rings()
    return [*visible, *_inner_rings(visible[-1]), *_bag_rings()]


def _visible_rings() -> list[Array]:
    """Return border, three rings of red, and the line where the lips touch."""
    along, lip = positions()
    a = np.abs(along)
    slit, upper, lower = curves(along)
    edge = np.where(lip > 0, upper, np.where(lip < 0, lower, slit))
    x = HALF_WIDTH * along
    border, contact = clay.cast_forward(x * 1.045, edge), clay.cast_forward(x, slit)
    fullness = (1 - a**2.2) ** 0.7
    is_upper = lip >= 0
    reach = np.where(is_upper, np.array([[0.0, 0.36, 0.72, 0.97, 1.0]]).T, np.array([[0.0, 0.36, 0.70, 0.96, 1.0]]).T)
    swell = np.where(is_upper, np.array([[0.04, 0.42, 0.88, 0.80, 0.0]]).T, np.array([[0.04, 0.62, 1.0, 0.80, 0.0]]).T)
    height = np.where(is_upper, 0.31, 0.39) * fullness + 0.03
    tubercle = np.where(lip > 0, 0.06 * np.exp(-((a / 0.18) ** 2)), 0)
    recess = 0.10 + 0.02 * fullness + 0.16 * a**6
    loops = []
    for ring in range(5):
        points = mix(border, contact, reach[ring][:, None])
        points[:, 1] = mix(edge, slit, reach[ring])
        offset = swell[ring] * (height + tubercle) - (ring / 4) ** 2 * recess
        loops.append(points + outward(points) * offset[:, None])
    loops[-1][:, 1] += lip * 0.004  # a gap of 0.08 mm keeps the lips two
    return loops


def _inner_rings(contact: Array) -> list[Array]:
    """Return the lips' inner side down to the groove before the gums."""
    along, lip = positions()
    fullness = (1 - np.abs(along) ** 2.2) ** 0.7
    away = outward(contact)

    def ring(back: float, spread: Array | float, narrowing: float) -> Array:
        points = contact - away * back
        points[:, 0] = contact[:, 0] * narrowing - away[:, 0] * back * 0.6
        points[:, 1] = contact[:, 1] + lip * spread
        return points

    return [
        ring(0.22, 0.012, 0.995),
        ring(0.45, 0.10 * fullness + 0.01, 0.99),
        ring(0.60, 0.55 * fullness + 0.03, 1.0),
        ring(1.15, 1.15 * fullness**0.7 + 0.05, 1.0),
    ]


def _bag_rings() -> list[Array]:
    """Return the bag round the dental arches and its one vertex at the back."""
    angle = 2 * np.pi * np.arange(POINTS) / POINTS
    across, above = -np.cos(angle), np.sin(angle)
    sizes = ((8.3, 2.9, 2.1), (6.6, 2.8, 2.0), (4.6, 1.9, 1.3))
    loops = [np.column_stack([across * w, -7.3 + above * h, np.full(POINTS, z)]) for z, w, h in sizes]
    return [*loops, np.array([[0, -7.4, 4.0]])]
