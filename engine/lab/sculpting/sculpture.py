"""The assembled head at rest, and the ways its shapes move it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import sparse

from engine.lab.modelling.solids import smooth_step
from engine.lab.sculpting import clay, hair, lips, parts
from engine.lab.sculpting.colours import skin_colours
from engine.lab.sculpting.parts import Part
from engine.lab.sculpting.skin import shape_skin
from engine.lab.sculpting.topology import Topology
from engine.take import Array, Mask

Indices = npt.NDArray[np.int64]
MIRROR = np.array([-1.0, 1.0, 1.0])


@dataclass(frozen=True, eq=False)
class Sculpture:
    """The head at rest. Skin vertices come first; the arrays from `ring` on are of the skin alone.

    Attributes
    ----------
    points : (n, 3), cm
    triangles : (triangles, 3)
    colours : (n, 3) sRGB, 0..1
    mirror : (n,) index of each vertex's mirror image
    at : vertices of a part by name
    topology, averaging : of the skin
    ring : ring of the mouth, 0 at its border on the grid; -1 elsewhere
    along : place along the lips, -1 right corner .. 1 left corner; 0 off the rings
    lip : +1 upper, -1 lower, 0 at corners and the back of the mouth; above or below the slit off the rings
    lid : ring of an eye, 0 at its border; -1 elsewhere
    normal : (skin, 3) unit normals of the clay
    front : 0 on the back of the head, 1 on the face
    jaw : how far the skin follows the jaw, 0..1
    """

    points: Array
    triangles: Indices
    colours: Array
    mirror: Indices
    at: dict[str, slice]
    topology: Topology
    averaging: sparse.csr_array
    ring: Indices
    along: Array
    lip: Array
    lid: Indices
    normal: Array
    front: Array
    jaw: Array

    @property
    def skin(self) -> Array:
        """Points of the skin, (skin, 3)."""
        return self.points[: len(self.ring)]

    def still(self) -> Array:
        """Return no motion at all, (n, 3)."""
        return np.zeros_like(self.points)

    def move_skin(self, amount: Array, direction: npt.ArrayLike) -> Array:
        """Return the motion of the skin by amount, (skin,), along one direction or one per vertex."""
        motion = self.still()
        motion[: len(amount)] = amount[:, None] * np.asarray(direction, np.float64)
        return motion

    def flip(self, motion: Array) -> Array:
        """Return the mirrored motion: what was left is right."""
        return np.asarray(motion[self.mirror] * MIRROR)

    def symmetric(self, motion: Array) -> Array:
        """Return the mean of a motion and its mirror image."""
        return 0.5 * (motion + self.flip(motion))

    def smooth(self, amount: Array, keep: Mask, rounds: int) -> Array:
        """Even out amounts over the skin, (skin,), holding those of `keep`."""
        return smooth(amount, keep, rounds, self.averaging)

    def slide(self, motion: Array, share: float = 1.0) -> Array:
        """Keep moved outer skin at its old distance from the clay, so that it slides round the face, not through it."""
        rest, offset = self.skin, motion[: len(self.ring)]
        moved = np.flatnonzero((np.abs(offset).sum(axis=1) > 1e-4) & (self.ring < 9) & (self.lid < 3))
        slid = motion.copy()
        slid[moved] += share * stay_off_clay(rest[moved], offset[moved])
        return slid

    @property
    def followers(self) -> Array:
        """How far skin takes part in motions of the face round it: the lids' rings less and less, (skin,)."""
        share = np.array([1.0, 0.8, 0.55, 0.3, 0.12, *np.zeros(9)])
        return share[self.lid + 1]


def stay_off_clay(rest: Array, offset: Array) -> Array:
    """Return the correction, (n, 3), that keeps moved points at their old distance from the clay."""
    moved = rest + offset
    slope = clay.gradient(moved)
    change = (clay.distance(moved) - clay.distance(rest)) / np.maximum((slope * slope).sum(axis=1), 0.3)
    return np.asarray(-change[:, None] * slope)


def smooth(amount: Array, keep: Mask, rounds: int, averaging: sparse.csr_array) -> Array:
    """Move amounts, (n,), half-way to their neighbours' mean in every round, except those of `keep`."""
    for _ in range(rounds):
        amount = np.where(keep, amount, 0.5 * amount + 0.5 * (averaging @ amount))
    return amount


def sculpt() -> Sculpture:
    """Assemble skin and parts, and note where every vertex of the skin lies."""
    skin = shape_skin()
    topology, rest = skin.topology, skin.topology.points
    points, triangles, colours, mirror, at = _joined(topology, _parts(rest, topology))
    ring, along, lip = _mouth_places(topology)
    lid = np.full(len(rest), -1)
    for loops in topology.eyes.values():
        for number, loop in enumerate(loops):
            lid[loop] = number
    return Sculpture(
        points=points,
        triangles=triangles,
        colours=colours,
        mirror=mirror,
        at=at,
        topology=topology,
        averaging=skin.averaging,
        ring=ring,
        along=along,
        lip=lip,
        lid=lid,
        normal=clay.normals(rest),
        front=smooth_step(1.0, 4.5, rest[:, 2]),
        jaw=smooth(_jaw_weights(rest, ring, along, lip, lid), (ring >= 3) | (lid >= 0), 16, skin.averaging),
    )


def _mouth_places(topology: Topology) -> tuple[Indices, Array, Array]:
    count = len(topology.points)
    ring, along = np.full(count, -1), np.zeros(count)
    lip = np.where(topology.points[:, 1] > lips.SLIT_Y, 1.0, -1.0)
    for number, loop in enumerate(topology.mouth[:-1]):
        ring[loop] = number
        along[loop], lip[loop] = lips.positions()
    back = topology.mouth[-1]
    ring[back], lip[back] = len(topology.mouth) - 1, 0.0
    return ring, along, lip


def _jaw_weights(rest: Array, ring: Indices, along: Array, lip: Array, lid: Indices) -> Array:
    """Return how far the skin follows the jaw: a field on the face, set by ring on the lips and in the mouth."""
    x, y, z = np.abs(rest[:, 0]), rest[:, 1], rest[:, 2]
    face = smooth_step(-4.6, -8.6, y) * smooth_step(-1.5, 5.0, z) * smooth_step(-14.5, -10.8, y)
    face *= 1 - 0.25 * smooth_step(3.0, 6.0, x)
    at_corner, towards_middle = 0.42, 1 - np.abs(along) ** 2.5
    on_lips = at_corner * np.where(lip > 0, 1 - towards_middle, 1.0)
    on_lips = np.where(lip < 0, at_corner + (1 - at_corner) * towards_middle, on_lips)
    share = np.clip((ring + 1) / 5.0, 0, 1)  # 0 at the grid, 1 on the lips
    weight = np.where(ring >= 0, face * (1 - share) + on_lips * share, face)
    depth = np.clip((ring - 11) / 5.0, 0, 1)
    in_bag = np.where(lip < 0, 0.9, np.where(lip > 0, 0.02, 0.45)) * (1 - depth) + 0.45 * depth
    return np.where(lid >= 0, 0.0, np.where(ring >= 12, in_bag, weight))


def _parts(rest: Array, topology: Topology) -> list[Part]:
    contact = rest[topology.mouth[8][: lips.POINTS // 2 + 1]]
    pairs = [parts.eyeball(), parts.ear(), hair.brow(), hair.lashes()]
    both = [part for left in pairs for part in (left, left.twin())]
    middle = [parts.teeth(contact, upper=True), parts.teeth(contact, upper=False), parts.tongue(), hair.cap()]
    return [*both, *middle]


def _joined(topology: Topology, pieces: list[Part]) -> tuple[Array, Indices, Array, Indices, dict[str, slice]]:
    """Return points, triangles, colours, mirror and the parts' places of skin and parts in one mesh."""
    skin = Part("skin", topology.points, topology.triangles(), skin_colours(topology), topology.mirror)
    at, mirror, triangles, start = {}, [], [], 0
    for part in (skin, *pieces):
        count = len(part.points)
        at[part.name] = slice(start, start + count)
        triangles.append(part.triangles + start)
        within = np.arange(count) if part.mirror is None else part.mirror
        # a left part's twin follows it at once
        to_twin = 0 if part.mirror is not None else count if part.name.endswith("_left") else -count
        mirror.append(within + start + to_twin)
        start += count
    points = np.concatenate([part.points for part in (skin, *pieces)])
    colours = np.concatenate([part.colours for part in (skin, *pieces)])
    return points, np.concatenate(triangles), colours, np.concatenate(mirror), at
