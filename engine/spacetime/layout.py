"""The layout of the 54 markers by a rule over landmarks, for any head that has them (SLS12 figure 5)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from engine.character import Character
from engine.errors import EditError
from engine.mesh import parts_of
from engine.take import SHAPE_INDEX, Array


@dataclass(frozen=True)
class Tuning:
    """Tolerances of the rule; ranges tried were not recorded."""

    reach: float = 0.15  # of half the distance of the eyes; how far beside the target a vertex may be
    depth: float = 0.2  # of the same; how far behind the foremost vertex a vertex may be
    jaw_slack: float = 0.2  # of the jaw's longest displacement; how far a marker may move beyond its two landmarks


TUNING = Tuning()


@dataclass(frozen=True)
class Place:
    """The place of a marker: a share of the way between two landmarks, then aside and up in half distances of the eyes.

    Without either the marker is the landmark itself; otherwise it is the foremost skin at that place.
    """

    name: str
    start: str
    end: str = ""
    share: float = 0.0
    aside: float = 0.0
    up: float = 0.0


_MIDDLE = (
    Place("forehead", "nose_bridge", up=1.7),
    Place("glabella", "nose_bridge", up=0.65),
    Place("nose_bridge", "nose_bridge"),
    Place("nose_middle", "nose_bridge", "nose_tip", 0.5),
    Place("nose_tip", "nose_tip"),
    Place("philtrum", "nose_tip", "lip_upper", 0.65),
    Place("lip_upper", "lip_upper"),
    Place("lip_lower", "lip_lower"),
    Place("chin_crease", "lip_lower", "chin", 0.45),
    Place("chin", "chin"),
)
_SIDE = (
    Place("forehead", "nose_bridge", aside=1.0, up=1.5),
    Place("brow_inner", "nose_bridge", aside=0.5, up=0.7),
    Place("brow_middle", "nose_bridge", aside=1.0, up=0.85),
    Place("brow_outer", "nose_bridge", aside=1.5, up=0.65),
    Place("temple", "nose_bridge", aside=1.95, up=0.4),
    Place("lid_upper", "lid_upper_left"),
    Place("lid_lower", "lid_lower_left"),
    Place("eye_inner", "lid_upper_left", "lid_lower_left", 0.5, aside=-0.5),
    Place("eye_outer", "lid_upper_left", "lid_lower_left", 0.5, aside=0.55),
    Place("under_eye", "lid_lower_left", up=-0.35),
    Place("cheekbone", "lid_lower_left", aside=0.55, up=-0.6),
    Place("nose_side", "nose_bridge", "nose_tip", 0.45, aside=0.35),
    Place("nostril", "nose_tip", aside=0.5),
    Place("nasolabial", "nose_tip", aside=0.85, up=-0.1),
    Place("cheek", "mouth_left", aside=0.6, up=0.65),
    Place("lip_upper", "lip_upper", "mouth_left", 0.5),
    Place("mouth", "mouth_left"),
    Place("lip_lower", "lip_lower", "mouth_left", 0.5, up=-0.08),
    Place("mouth_side", "mouth_left", aside=0.55, up=-0.1),
    Place("below_corner", "mouth_left", up=-0.5),
    Place("jaw", "mouth_left", aside=0.6, up=-0.65),
    Place("chin", "chin", aside=0.55, up=0.15),
)


def _sided(place: Place, side: str) -> Place:
    sign = 1.0 if side == "left" else -1.0
    start, end = (name.replace("_left", f"_{side}") for name in (place.start, place.end))
    return Place(f"{place.name}_{side}", start, end, place.share, sign * place.aside, place.up)


PLACES: tuple[Place, ...] = (*_MIDDLE, *(_sided(place, side) for place in _SIDE for side in ("left", "right")))
MARKERS: tuple[str, ...] = tuple(place.name for place in PLACES)


@dataclass(frozen=True, eq=False)
class Layout:
    """The vertices of a character that carry the markers.

    Attributes
    ----------
    names : of the markers
    vertices : (n,) vertex index of each
    """

    names: tuple[str, ...]
    vertices: npt.NDArray[np.int64]

    def rest(self, character: Character) -> Array:
        """Return the markers on the face at rest, (n, 3) mm."""
        return character.neutral[self.vertices].astype(np.float64)

    def deltas(self, character: Character) -> Array:
        """Return the displacement of each marker by each shape, (52, n, 3) mm."""
        return character.deltas[:, self.vertices].astype(np.float64)

    def pick(self, names: Sequence[str]) -> Layout:
        """Return the layout of some of its markers, in the order given; raises `EditError` for a marker it lacks."""
        index = {name: place for place, name in enumerate(self.names)}
        missing = [name for name in names if name not in index]
        if missing:
            raise EditError(f"The layout has no marker {missing[0]!r}.", f"It has: {', '.join(self.names)}.")
        return Layout(tuple(names), self.vertices[[index[name] for name in names]])


def named(vertices: Mapping[str, int]) -> Layout:
    """Return the layout of a landmark file: vertices by marker name."""
    return Layout(tuple(vertices), np.array(list(vertices.values()), np.int64))


def standard(character: Character) -> Layout:
    """Return the 54 markers of a character; raises `EditError` that names the landmarks it lacks."""
    needed = dict.fromkeys(name for place in PLACES for name in (place.start, place.end) if name)
    missing = [name for name in needed if name not in character.landmarks]
    if missing:
        raise EditError(
            f"The character {character.name!r} lacks the landmarks {', '.join(missing)}.",
            "Name a landmark file that says which vertex carries which marker.",
        )
    points = character.neutral.astype(np.float64)
    skin = _skin(character)
    return Layout(MARKERS, np.array([_vertex(place, character, points, skin) for place in PLACES]))


def _vertex(place: Place, character: Character, points: Array, skin: npt.NDArray[np.int64]) -> int:
    start = points[character.landmarks[place.start]]
    if not (place.end or place.aside or place.up):
        return character.landmarks[place.start]
    end = points[character.landmarks[place.end]] if place.end else start
    unit = abs(points[character.landmarks["lid_upper_left"]] - points[character.landmarks["lid_upper_right"]])[0] / 2
    target = start + place.share * (end - start) + unit * np.array([place.aside, place.up, 0.0])
    return _in_front(target, points, _with_jaw(place, character, skin), unit)


def _with_jaw(place: Place, character: Character, skin: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Return the skin that moves with the jaw as two landmarks do, so that no lower lip stands for an upper."""
    if not place.end:
        return skin
    way = np.linalg.norm(character.deltas[SHAPE_INDEX["jawOpen"]], axis=1)
    ends = way[[character.landmarks[place.start], character.landmarks[place.end]]]
    slack = TUNING.jaw_slack * way.max()
    follows = (way[skin] >= ends.min() - slack) & (way[skin] <= ends.max() + slack)
    return np.asarray(skin[follows], np.int64)


def _in_front(target: Array, points: Array, skin: npt.NDArray[np.int64], unit: float) -> int:
    """Return the vertex of the skin that a viewer in front sees at a place; ties break towards the middle of the face."""
    beside = np.hypot(*(points[skin, :2] - target[:2]).T)
    near = skin[beside <= max(TUNING.reach * unit, float(beside.min()) + 1e-6)]
    front = near[points[near, 2] >= points[near, 2].max() - TUNING.depth * unit]
    distance = np.round(np.hypot(*(points[front, :2] - target[:2]).T), 3)
    return int(front[np.lexsort((abs(points[front, 0]), distance))[0]])


def _skin(character: Character) -> npt.NDArray[np.int64]:
    """Return the vertices connected to the tip of the nose: no eyes, teeth or brows."""
    part = parts_of(character.triangles, len(character.neutral))
    return np.flatnonzero(part == part[character.landmarks["nose_tip"]])
