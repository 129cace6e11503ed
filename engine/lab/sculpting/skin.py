"""The skin: the topology's points placed on the clay, lids, lips and nostrils in their loops."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from engine.lab.modelling.solids import mix
from engine.lab.sculpting import clay, eyelids, lips
from engine.lab.sculpting.topology import Topology, skin_topology
from engine.take import Array, Mask

_MIRROR = np.array([-1.0, 1.0, 1.0])


@dataclass(frozen=True)
class Skin:
    """The finished skin: its topology with every point placed, and the matrix that averages over neighbours."""

    topology: Topology
    averaging: sparse.csr_array


def shape_skin() -> Skin:
    """Place every vertex of the skin; left and right are exact mirror images."""
    topology = skin_topology()
    averaging = topology.averaging()
    points = topology.points.copy()
    fixed = np.zeros(len(points), bool)
    fixed[topology.neck_floor] = True
    _place_eyes(points, fixed, topology)
    _place_mouth(points, fixed, topology)
    _place_nostrils(points, fixed, topology)
    points = _relax(points, ~fixed, averaging)
    points = 0.5 * (points + points[topology.mirror] * _MIRROR)
    return Skin(replace(topology, points=points), averaging)


def _place_eyes(points: Array, fixed: Mask, topology: Topology) -> None:
    left, right = topology.eyes["left"], topology.eyes["right"]
    lids = eyelids.rings()
    for ring, place in enumerate(lids, start=eyelids.SKIN_RINGS):
        points[left[ring]], points[right[ring]] = place, place * _MIRROR
        fixed[left[ring]] = fixed[right[ring]] = True
    for ring, share in ((1, 0.30), (2, 0.58), (3, 0.82)):
        place = clay.project(mix(points[left[0]], lids[0], share), rounds=6)
        points[left[ring]], points[right[ring]] = place, place * _MIRROR


def _place_mouth(points: Array, fixed: Mask, topology: Topology) -> None:
    loops = topology.mouth
    for ring, place in enumerate(lips.rings(), start=lips.SKIN_RINGS):
        points[loops[ring]] = place
        fixed[loops[ring]] = True
    border = points[loops[lips.SKIN_RINGS]]
    for ring, share in ((1, 0.32), (2, 0.6), (3, 0.83)):
        points[loops[ring]] = clay.project(mix(points[loops[0]], border, share), rounds=6)


def _place_nostrils(points: Array, fixed: Mask, topology: Topology) -> None:
    """Lay ovals on the underside of the nose, then push a small pit up and back."""
    border, rim = (_nostril_oval(size) for size in (1.0, 0.62))
    middle = rim.mean(axis=0)
    pit = [
        border,
        rim,
        mix(rim, middle, 0.15) + np.array([0, 0.16, -0.03]),
        mix(rim, middle, 0.4) + np.array([0, 0.45, -0.10]),
        middle[None] + np.array([0, 0.60, -0.15]),
    ]
    for ring, place in enumerate(pit):
        for side, sign in (("left", np.ones(3)), ("right", _MIRROR)):
            points[topology.nostrils[side][ring]] = place * sign
            fixed[topology.nostrils[side][ring]] = True


def _nostril_oval(size: float) -> Array:
    """Return a loop on the underside of the left half of the nose, from its inner side over the front, (10, 3)."""
    turn = np.pi * (1 - np.arange(10) / 5)[:, None]
    across, forward = np.array([0.92, -0.05, -0.38]), np.array([-0.38, 0.38, 0.86])
    oval = size * (0.44 * np.cos(turn) * across + 0.60 * np.sin(turn) * forward)
    return clay.project(np.array([0.95, -4.25, 11.6]) + oval, rounds=6)


def _relax(points: Array, free: Mask, averaging: sparse.csr_array, rounds: int = 14, rate: float = 0.5) -> Array:
    """Even out the free vertices by sliding each towards its neighbours' mean along the clay."""
    moving = np.flatnonzero(free)
    rows = averaging[moving]
    for _ in range(rounds):
        normal = clay.normals(points[moving])
        step = rows @ points - points[moving]
        step -= (step * normal).sum(axis=1, keepdims=True) * normal
        points[moving] = clay.project(points[moving] + rate * step, rounds=1)
    points[moving] = clay.project(points[moving], rounds=4)
    return points
