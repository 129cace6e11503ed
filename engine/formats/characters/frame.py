"""Unit and axes of a file, told by the face: by where eyes and mouth are and which way the jaw opens."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations

import numpy as np
import numpy.typing as npt

from engine.character import bundled
from engine.formats.characters.eyes import eyeballs
from engine.formats.characters.names import Match
from engine.formats.characters.raw import RawCharacter
from engine.take import SHAPES, Array

UNITS_MM = {"mm": 1.0, "cm": 10.0, "in": 25.4, "m": 1000.0}
UPS = ("y", "z", "x", "-y", "-z", "-x")
HEAD_MM = (150.0, 700.0)  # height of a head, from chin-to-crown alone to head and shoulders
TYPICAL_MM = 280.0
BODY = 3.0  # height by depth from which a mesh without a face to go by is a whole body, eight heads high
BODY_MM = 1700.0
EYES_APART_MM = 64.0
FAR_MM = 20.0  # how far apart two moving places are on the bundled head for their distance to tell the size
REACH = 2.5  # distances of the eyes about the face, within which a head lies
SNAP_DEG = {90: 12.0, 45: 8.0}  # a face within so much of an axis, or of the middle between two, is turned to it
EYES = ("eyeBlink", "eyeSquint", "eyeWide", "eyeLook", "brow")
MOUTH = ("mouth", "jaw")
# Which way a shape moves the skin on any face, in our frame: of these all others are judged.
MOVES_UP = {"jawOpen": -1.0, "browInnerUp": 0.5, "browOuterUpLeft": 0.5, "browOuterUpRight": 0.5, "eyeBlinkLeft": -0.5}
MOVES_UP |= {"eyeBlinkRight": -0.5, "mouthFrownLeft": -0.3, "mouthFrownRight": -0.3}
MOVES_AHEAD = {"mouthPucker": 0.5, "mouthFunnel": 0.5, "jawForward": 1.0, "jawOpen": -0.3}


@dataclass(frozen=True)
class Frame:
    """How a file's coordinates become ours: millimetres, Y up, Z forward, the character's left at +X.

    Attributes
    ----------
    unit : name of the file's unit, a key of UNITS_MM
    up : the file's upward axis, one of UPS
    facing_deg : how far the face is turned to its own left from z, or from -y where z is up, about the upward axis
    """

    unit: str
    up: str
    facing_deg: float = 0.0

    @property
    def axes(self) -> Array:
        """Return the character's left, up and front in the file's coordinates, the rows of a (3, 3) rotation."""
        up = axis(self.up)
        ahead = axis("-y") if self.up[-1] == "z" else axis("z")
        angle = np.radians(self.facing_deg)
        front = np.cos(angle) * ahead + np.sin(angle) * np.cross(up, ahead)
        return np.asarray(np.round(np.stack([np.cross(up, front), up, front]), 12) + 0.0)

    @property
    def matrix(self) -> Array:
        """Return the (3, 3) that takes the file's rows to ours."""
        return np.asarray(UNITS_MM[self.unit] * self.axes.T)

    @property
    def facing(self) -> str:
        """Return the axes that the face looks along, such as -y or x+y; an angle where it is between them."""
        front = self.axes[2]
        if self.facing_deg % 45:
            return f"{self.facing_deg:.0f}° to its left"
        named = [
            f"{'-' if value < 0 else '+'}{name}" for name, value in zip("xyz", front, strict=True) if abs(value) > 0.1
        ]
        return "".join(named).removeprefix("+")


def axis(name: str) -> Array:
    """Return the unit vector of an axis such as -z."""
    return np.asarray(np.eye(3)["xyz".index(name[-1])] * (-1.0 if name.startswith("-") else 1.0))


@dataclass(frozen=True, eq=False)
class Motion:
    """Where and which way a shape moves a face, in the unit and axes of its mesh.

    Attributes
    ----------
    centre : (3,) the middle of what moves most
    way : (3,) the mean motion there, relative to its mean length: shorter than 1 where parts go apart
    extent : diagonal of the box about what moves most
    """

    centre: Array
    way: Array
    extent: float


def motions_of(vertices: Array, deltas: Mapping[str, npt.NDArray[np.float32]]) -> dict[str, Motion]:
    """Return the motion of each shape that moves anything, by name."""
    found = {}
    for name, delta in deltas.items():
        travel = np.linalg.norm(delta, axis=1).astype(np.float64)
        largest = float(travel.max(initial=0.0))
        if largest > 0:
            moving = np.flatnonzero(travel > largest / 2)
            share = travel[moving] / travel[moving].sum()
            way = delta[moving].sum(axis=0, dtype=np.float64) / travel[moving].sum()
            extent = float(np.linalg.norm(np.ptp(vertices[moving], axis=0)))
            found[name] = Motion(share @ vertices[moving], way, extent)
    return found


@lru_cache(maxsize=1)
def _usual() -> dict[str, Motion]:
    head = bundled()
    return motions_of(head.neutral.astype(np.float64), dict(zip(SHAPES, head.deltas, strict=True)))


@dataclass(frozen=True, eq=False)
class Detection:
    """A frame and what speaks against it.

    Attributes
    ----------
    frame : what was found
    apart : size of the face, in the file's unit by mm of the bundled head's; NaN where nothing tells it
    exchanged : whether the file's left shapes are on the right
    """

    frame: Frame
    apart: float
    exchanged: bool = False


def detect(raw: RawCharacter, rows: Sequence[Match], *, unit: str = "", up: str = "") -> Detection:
    """Tell unit, upward axis and facing by the face; what is given, or prescribed by the format, is kept.

    The unit is the one in which the places that the shapes move are as far apart as on the bundled head, or the eyeballs
    of a mesh without shapes as eyes are; never the height of what may be a whole body, where there is a face to go by.
    """
    unit, up = unit or raw.unit, up or raw.up
    motions = motions_of(raw.vertices, {row.shape: raw.shapes[row.source] for row in rows if row.sure})
    if motions:
        left, size = _left(motions), _size(motions)
        if left.any():
            up = up or _up(motions, left)
            facing, exchanged = _facing(raw.vertices, motions, axis(up), left, size)
        else:
            up, facing = _without_sides(raw.vertices, motions, up, size)
            exchanged = False
    else:
        box = np.ptp(raw.vertices, axis=0)
        usual = float("nan"), up or ("y" if box[1] >= box[2] else "z"), 0.0
        size, up, facing = _by_eyeballs(raw, up) or usual
        exchanged = False
    scale = size if np.isfinite(size) else _by_height(raw.vertices, up)
    found = unit or min(UNITS_MM, key=lambda name: abs(np.log(scale * UNITS_MM[name])))
    return Detection(Frame(found, up, _snapped(facing)), size, exchanged)


def _pairs(motions: Mapping[str, Motion]) -> list[tuple[str, str]]:
    lefts = [name for name in motions if name.endswith("Left") and not name.startswith(("jaw", "mouthLeft"))]
    return [(name, f"{name[:-4]}Right") for name in lefts if f"{name[:-4]}Right" in motions]


def _left(motions: Mapping[str, Motion]) -> Array:
    """Return the direction to the character's left, (3,) of length 1, by the names of sides; zero where none tells it."""
    ways = [_unit(motions[left].centre - motions[right].centre) for left, right in _pairs(motions)]
    ways += [sign * _unit(motions[name].way) for name, sign in _SIDEWAYS.items() if name in motions]
    return _unit(np.sum(ways, axis=0)) if ways else np.zeros(3)


_SIDEWAYS = {"jawLeft": 1.0, "jawRight": -1.0, "mouthLeft": 1.0, "mouthRight": -1.0}


def _size(motions: Mapping[str, Motion]) -> float:
    """Return how large the face is, relative to the bundled head in mm: the median of what distances say.

    Where there are none, of how wide the moving places are.
    """
    usual = _usual()
    ratios = []
    for first, second in combinations([name for name in motions if name in usual], 2):
        typical = float(np.linalg.norm(usual[first].centre - usual[second].centre))
        apart = float(np.linalg.norm(motions[first].centre - motions[second].centre))
        if typical > FAR_MM and apart > 0:
            ratios.append(apart / typical)
    if not ratios:
        ratios = [
            motion.extent / usual[name].extent
            for name, motion in motions.items()
            if name in usual and motion.extent > 0
        ]
    return float(np.median(ratios)) if ratios else float("nan")


def _up(motions: Mapping[str, Motion], left: Array) -> str:
    """Return the axis that lies nearest to up, across the line between the sides."""
    way = sum((weight * motions[name].way for name, weight in MOVES_UP.items() if name in motions), np.zeros(3))
    eyes, mouth = (_middle_of(motions, kinds) for kinds in (EYES, MOUTH))
    if eyes is not None and mouth is not None:
        way = way + _unit(eyes - mouth)
    across = [name for name in UPS if abs(axis(name) @ left) < 0.6] or list(UPS)
    way = way - (way @ left) * left
    return max(across, key=lambda name: (round(float(axis(name) @ way), 6), -UPS.index(name)))


def _facing(vertices: Array, motions: Mapping[str, Motion], up: Array, left: Array, size: float) -> tuple[float, bool]:
    """Return how far the face is turned, in degrees as `Frame` has it, and whether the names of its sides are exchanged."""
    face = np.mean([motion.centre for motion in motions.values()], axis=0)
    ahead = face - _middle_of_head(vertices, face, size)
    ahead = ahead / max(size * EYES_APART_MM, 1e-300) if np.isfinite(size) else _unit(ahead)
    ahead = ahead + sum((w * motions[name].way for name, w in MOVES_AHEAD.items() if name in motions), np.zeros(3))
    across = left - (left @ up) * up
    if np.linalg.norm(across) < 0.3:  # the sides lie above each other: the upward axis given is not the face's
        return 90.0 * round(_angle(ahead, up) / 90), False
    front = _unit(np.cross(across, up))
    exchanged = bool(front @ ahead < -0.15)  # further behind than a flat mask can be told to be
    return _angle(-front if exchanged else front, up), exchanged


def _without_sides(vertices: Array, motions: Mapping[str, Motion], up: str, size: float) -> tuple[str, float]:
    """Return upward axis and facing, a quarter turn at best, where no shape has a side.

    The face lies in front of the middle of its head and moves as faces do; nothing of that points aside.
    """
    face = np.mean([motion.centre for motion in motions.values()], axis=0)
    ahead = _unit(face - _middle_of_head(vertices, face, size))
    rising, coming = (
        sum((weight * motions[name].way for name, weight in table.items() if name in motions), np.zeros(3))
        for table in (MOVES_UP, MOVES_AHEAD)
    )

    def score(frame: Frame) -> float:
        left, upward, front = frame.axes
        aside = abs(float(ahead @ left)) + abs(float((rising + coming) @ left))
        return round(float(rising @ upward + coming @ front + 2 * ahead @ front) - aside, 6)

    quarters = (0.0, 180.0, 90.0, -90.0)
    best = max((Frame("m", name, turn) for name in ((up,) if up else UPS) for turn in quarters), key=score)
    return best.up, best.facing_deg


def _middle_of_head(vertices: Array, face: Array, size: float) -> Array:
    """Return the middle of the box about the vertices that are as near to the face, (3,), as a head's are, (3,)."""
    if np.isfinite(size):
        near = vertices[np.linalg.norm(vertices - face, axis=1) < REACH * EYES_APART_MM * size]
        vertices = near if len(near) else vertices
    return np.asarray((vertices.min(axis=0) + vertices.max(axis=0)) / 2)


def _by_eyeballs(raw: RawCharacter, up: str) -> tuple[float, str, float] | None:
    """Return size, upward axis and facing that a mesh's eyeballs tell; none where it has none.

    They lie in front of the middle of their head, and neither aside of it nor, by much, above.
    """
    found = eyeballs(raw.vertices, raw.triangles)
    if found is None:
        return None
    line, middle = found[0].centre - found[1].centre, (found[0].centre + found[1].centre) / 2
    size = float(np.linalg.norm(line)) / EYES_APART_MM
    across = _unit(line)
    ahead = middle - _middle_of_head(raw.vertices, middle, size)
    ahead = _unit(ahead - (ahead @ across) * across)
    up = up or min(
        (name for name in UPS[:3] if abs(axis(name) @ across) < 0.6), key=lambda name: abs(float(axis(name) @ ahead))
    )
    front = np.cross(across, axis(up))
    return size, up, _angle(front if front @ ahead > 0 else -front, axis(up))


def _by_height(vertices: Array, up: str) -> float:
    """Return the size that the height of a mesh tells where there is no face to go by."""
    box = np.ptp(vertices, axis=0)
    height = float(np.abs(axis(up)) @ box)
    across = float(np.sort(box)[0])
    if height > BODY * max(across, 1e-300):
        return height / BODY_MM
    inside = [mm for mm in UNITS_MM.values() if HEAD_MM[0] <= height * mm <= HEAD_MM[1]]
    return 1 / inside[0] if len(inside) == 1 else height / TYPICAL_MM


def _middle_of(motions: Mapping[str, Motion], kinds: tuple[str, ...]) -> Array | None:
    centres = [motion.centre for name, motion in motions.items() if name.startswith(kinds)]
    return np.mean(centres, axis=0) if centres else None


def _angle(front: Array, up: Array) -> float:
    """Return how far a direction is turned about an upward axis, in degrees as `Frame` has it."""
    ahead = axis("-y") if abs(up[2]) > 0.5 else axis("z")
    return float(np.degrees(np.arctan2(front @ np.cross(up, ahead), front @ ahead)))


def _snapped(angle: float) -> float:
    for step, reach in SNAP_DEG.items():
        nearest = step * round(angle / step)
        if abs(angle - nearest) <= reach:
            return float((nearest + 180) % 360 - 180) if nearest % 360 != 180 else 180.0
    return float(round(angle))


def _unit(vector: Array) -> Array:
    return np.asarray(vector / max(float(np.linalg.norm(vector)), 1e-300))
