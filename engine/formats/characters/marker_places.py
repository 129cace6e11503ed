"""Which markers of a capture are which landmarks, by where they are on the face at rest, whatever they are called."""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist

from engine.character import Character, bundled
from engine.errors import EditError
from engine.formats.characters.marker_table import MarkerMatch, MarkerTable
from engine.formats.characters.marker_words import words_of
from engine.formats.characters.placing import place_rest
from engine.manifold.pose import fit_similarity
from engine.spacetime.layout import MARKERS, standard
from engine.take import Array, Mask
from engine.words import counted

Indices = npt.NDArray[np.int64]
FEWEST_BY_WORDS = 4  # markers whose names tell how the head is turned
FEWEST_BY_PLACE = 8  # markers whose places alone tell a face
ROUNDS, REFINED = 12, 8  # of pairing and fitting: alike in all directions, then stretched
STRETCH = (0.75, 1.33)  # of one axis against the others: faces differ so much and no more
EDGES = (5, 95)  # percentiles between which a cloud of markers extends
CLOSEST = 0.75  # share of the pairs that a fit goes by: some markers have no landmark near
LIKE_A_FACE = 0.15  # distances of the eyes: mean of those pairs; 0.04..0.11 on faces, 0.15..0.18 on scattered points
NEAR, NEAR_NAMED = 0.25, 0.42  # the same: how near a marker must come to a landmark to be it, and if its name means it
TURNED_AGAIN = 4  # rounds in which the rotation follows the pairs that names allow
ALIEN = 0.5  # the same: what a landmark of an area that the marker's name does not mean counts as further away
# Words in markers' names and the landmarks they mean; a name without any goes by its place alone.
AREAS = {
    "brow": ("brow_", "glabella"),
    "forehead": ("forehead", "temple"),
    "temple": ("temple",),
    "eye": ("lid_", "eye_"),
    "lid": ("lid_", "eye_"),
    "nose": ("nose_", "nostril"),
    "nostril": ("nostril", "nose_"),
    "mouth": ("lip_", "mouth"),
    "lip": ("lip_", "mouth"),
    "cheek": ("cheek", "nasolabial", "under_eye"),
    "chin": ("chin", "jaw", "below_corner"),
    "jaw": ("jaw", "chin", "below_corner"),
}


def match_markers(points: Array, names: Sequence[str]) -> MarkerTable:
    """Tell which markers are which landmarks: those named like one by name, the others by place on the face at rest.

    The markers are laid onto those of the bundled head from every direction, by a similarity and then with other
    proportions; each goes to the landmark that it comes to lie on, no landmark twice (assignment of least distance).

    Parameters
    ----------
    points : (n, 3) mm, the markers on the face at rest; NaN where one was not seen
    names : of the markers

    Raises
    ------
    EditError : where the names tell too little and the places are no face's
    """
    by_name = _by_name(names)
    seen: Mask = np.asarray(np.isfinite(points).all(axis=1))
    rest = standard(bundled()).rest(bundled())
    known = [index for index in by_name if seen[index]]
    if len(known) >= FEWEST_BY_PLACE:
        goals = rest[[MARKERS.index(by_name[index]) for index in known]]
        return _table(names, by_name, {}, fit_similarity(points[known], goals[None], mirrored=False).turn[0])
    if len(by_name) == len(names):  # too few to tell the head's axes better than the file does
        return _table(names, by_name, {}, np.eye(3))
    rows: Indices = np.flatnonzero(seen)
    if len(rows) < FEWEST_BY_PLACE:
        if (table := _by_words(points, names, seen, rest)) is not None:
            return table
        raise EditError(
            f"Only {len(known)} of the {counted(len(names), 'marker')} called like a landmark, too few to find the others.",
            "Name a landmark file that says which vertex carries which marker.",
        )
    apart = float(np.linalg.norm(rest[MARKERS.index("lid_upper_left")] - rest[MARKERS.index("lid_upper_right")]))
    alien, meant = _alien([names[int(row)] for row in rows])
    laid, turn, away = _laid(points[rows], rest, ALIEN * apart * alien)
    reach = np.where(meant, NEAR_NAMED, NEAR)
    if away > LIKE_A_FACE * apart:
        if (table := _by_words(points, names, seen, rest)) is not None:
            return table
        raise EditError(
            "The markers do not lie on a face as its landmarks do.",
            "Choose a frame in which the face is at rest, or name a landmark file for them.",
        )
    return _table(names, by_name, _assigned(laid, rest, rows, by_name, near=reach * apart, alien=alien), turn)


def _by_name(names: Sequence[str]) -> dict[int, str]:
    """Return the landmark of each marker that is called like one, by its number: its own name before another spelling."""
    plain = {_plain(landmark): landmark for landmark in MARKERS}
    found = {index: name for index, name in enumerate(names) if name in MARKERS}
    for index, name in enumerate(names):
        landmark = plain.get(_plain(name), "")
        if landmark and index not in found and landmark not in found.values():
            found[index] = landmark
    return found


def _by_words(points: Array, names: Sequence[str], seen: Mask, rest: Array) -> MarkerTable | None:
    """Return the markers whose names say in any words which landmark they are, where places tell nothing; None for few."""
    meant = {words_of(landmark): landmark for landmark in MARKERS}
    found: dict[int, str] = {}
    for index, name in enumerate(names):
        landmark = meant.get(words_of(name), "")
        if landmark and seen[index] and landmark not in found.values():
            found[index] = landmark
    if len(found) < FEWEST_BY_WORDS:
        return None
    goals = rest[[MARKERS.index(landmark) for landmark in found.values()]]
    return _table(names, found, {}, fit_similarity(points[list(found)], goals[None], mirrored=False).turn[0])


def _plain(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.lower())


def _table(
    names: Sequence[str], by_name: Mapping[int, str], by_place: Mapping[int, tuple[str, float]], turn: Array
) -> MarkerTable:
    rows = []
    for index, name in enumerate(names):
        if index in by_name:
            rows.append(MarkerMatch(name, by_name[index], 0.0, "by name"))
        else:
            landmark, away = by_place.get(index, ("", 0.0))
            rows.append(MarkerMatch(name, landmark, round(away, 1), "by place"))
    return MarkerTable(tuple(rows), turn)


def _alien(names: Sequence[str]) -> tuple[Array, Mask]:
    """Return 1 for each landmark that a marker's name speaks against, (n, landmarks), and whether it speaks, (n,)."""
    result = np.zeros((len(names), len(MARKERS)))
    for row, name in enumerate(names):
        words = [word for word in AREAS if word in _plain(name)]
        words = [word for word in words if not any(word != other and word in other for other in words)]
        if "brow" in words:
            words = ["brow"]  # an eyebrow is no eye
        meant = tuple(part for word in words for part in AREAS[word])
        if meant:
            result[row] = [not landmark.startswith(meant) for landmark in MARKERS]
    return result, np.asarray(result.any(axis=1))


def _laid(points: Array, rest: Array, alien: Array) -> tuple[Array, Array, float]:
    """Return markers, (n, 3), laid onto a face's, the rotation that it took, and how far they are away, mm."""
    spread = [float(np.sqrt(((cloud - cloud.mean(axis=0)) ** 2).sum(axis=1).mean())) for cloud in (points, rest)]
    scaled = (points - points.mean(axis=0)) * spread[1] / max(spread[0], 1e-300)
    tried: list[tuple[float, int, Array, Array]] = []
    for start in _directions():
        _, turn = _fitted(scaled, scaled @ start + rest.mean(axis=0), rest)
        laid = _stretched(scaled @ turn, rest, alien)
        tried.append((_apart(laid, rest, alien), len(tried), laid, turn))
    _, _, laid, turn = min(tried, key=lambda each: each[:2])
    for _ in range(TURNED_AGAIN):
        ours, theirs = _partners(laid, rest, alien)
        turn = fit_similarity(scaled[ours], rest[theirs][None], mirrored=False).turn[0]
        laid = _stretched(scaled @ turn, rest, alien)
    return laid, turn, _apart(laid, rest, alien)


def _partners(laid: Array, rest: Array, alien: Array) -> tuple[Indices, Indices]:
    """Return numbers of markers and landmarks that the assignment of least distance pairs, the closest of them."""
    gaps = cdist(laid, rest) + alien
    ours, theirs = linear_sum_assignment(gaps)
    close = gaps[ours, theirs] <= np.quantile(gaps[ours, theirs], CLOSEST)
    return np.asarray(ours[close], np.int64), np.asarray(theirs[close], np.int64)


def _directions() -> list[Array]:
    """Return the 24 rotations that take axes to axes, and as many half a quarter turn away from them."""
    straight = []
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1.0, -1.0), repeat=3):
            turn = np.eye(3)[list(order)] * np.array(signs)
            if np.linalg.det(turn) > 0:
                straight.append(turn)
    half = np.sqrt(0.5)
    about_up = np.array([[half, 0, -half], [0, 1, 0], [half, 0, half]])
    return straight + [turn @ about_up for turn in straight]


def _fitted(points: Array, laid: Array, rest: Array) -> tuple[Array, Array]:
    """Return markers as a similarity lays them onto a face's, found by pairing both ways in turn, and its rotation."""
    turn = np.eye(3)
    for _ in range(ROUNDS):
        ours, theirs = _pairs(laid, rest)
        pose = fit_similarity(points[ours], rest[theirs][None], mirrored=False)
        laid, turn = pose.apply(points)[0], pose.turn[0]
    return laid, turn


def _pairs(laid: Array, rest: Array) -> tuple[Indices, Indices]:
    """Return numbers of markers and of landmarks next to each other, those of the closest pairs, each way."""
    gaps = cdist(laid, rest)
    there, back = gaps.argmin(axis=1), gaps.argmin(axis=0)
    ours = np.concatenate([np.arange(len(laid)), back])
    theirs = np.concatenate([there, np.arange(len(rest))])
    away = gaps[ours, theirs]
    close = away <= np.quantile(away, CLOSEST)
    return np.asarray(ours[close], np.int64), np.asarray(theirs[close], np.int64)


def _apart(laid: Array, rest: Array, alien: Array) -> float:
    """Return the mean distance of the closest pairs, each way, in mm."""
    gaps = cdist(laid, rest) + alien
    both = [np.sort(gaps.min(axis=side)) for side in (0, 1)]
    return float(np.mean([near[: max(1, int(CLOSEST * len(near)))].mean() for near in both]))


def _stretched(turned: Array, rest: Array, alien: Array) -> Array:
    """Return markers, upright, moved and sized along each axis to lie on a face's: as a whole, then by their pairs."""
    (low, high), (ours_low, ours_high) = (np.percentile(cloud, EDGES, axis=0) for cloud in (turned, rest))
    size = (ours_high - ours_low) / np.maximum(high - low, 1e-9)
    laid = (turned - (low + high) / 2) * _even(size) + (ours_low + ours_high) / 2
    for _ in range(REFINED):
        ours, theirs = _partners(laid, rest, alien)
        start, goal = turned[ours], rest[theirs]
        middle, aim = start.mean(axis=0), goal.mean(axis=0)
        size = ((start - middle) * (goal - aim)).sum(axis=0) / np.maximum(((start - middle) ** 2).sum(axis=0), 1e-9)
        laid = (turned - middle) * _even(size) + aim
    return np.asarray(laid)


def _even(size: Array) -> Array:
    """Return the sizes along three axes, none further from their middle than faces differ."""
    middle = float(np.median(size))
    return np.asarray(np.clip(size, STRETCH[0] * middle, STRETCH[1] * middle))


def _assigned(
    laid: Array, rest: Array, rows: Indices, by_name: Mapping[int, str], *, near: Array, alien: Array
) -> dict[int, tuple[str, float]]:
    """Return landmark and distance, within `near`, (n,) mm, for each marker that lies on one, by its number."""
    gaps = cdist(laid, rest)
    cost = np.where(alien > 0, np.inf, gaps)
    cost[:, [MARKERS.index(landmark) for landmark in by_name.values()]] = np.inf
    cost[[place for place, row in enumerate(rows) if int(row) in by_name]] = np.inf
    ours, theirs = linear_sum_assignment(np.minimum(cost, 2 * near[:, None]))
    return {
        int(rows[row]): (MARKERS[column], float(gaps[row, column]))
        for row, column in zip(ours, theirs, strict=True)
        if cost[row, column] <= near[row]
    }


def places_on(
    head: Character, points: Array, names: Sequence[str], table: MarkerTable, given: Mapping[str, int] | None = None
) -> dict[str, int]:
    """Return a vertex of a head for each marker of a capture but those left out.

    Landmarks go to the head's own; what lies between follows them, as `place_rest` does.

    Parameters
    ----------
    head : with landmarks
    points : (n, 3) mm, the markers on the face at rest
    names : of the markers
    table : from `match_markers`
    given : vertices that were placed by hand, by name
    """
    layout = standard(head)
    vertex = dict(zip(layout.names, layout.vertices.tolist(), strict=True))
    placed = {marker: vertex[landmark] for marker, landmark in table.landmarks.items()} | dict(given or {})
    kept = [index for index, name in enumerate(names) if name not in table.left_out]
    usable = [index for index in kept if np.isfinite(points[index]).all()]
    chosen = [names[index] for index in usable]
    leading = {name: placed[name] for name in chosen if name in placed}
    if len(leading) == len(chosen):
        return leading
    return place_rest(points[usable], chosen, head, leading)
