"""Landmarks from the bundled head to another one: a rigid fit with scale, then the nearest vertex that moves alike."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy.spatial import KDTree
from scipy.spatial.distance import cdist

from engine.character import Character, bundled
from engine.errors import EditError
from engine.manifold.pose import fit_similarity
from engine.mesh import parts_of
from engine.take import SHAPES, Array

MOVED_MM = 1.0
LED_MM = 40.0  # how far a landmark placed by hand leads
STRIP_MM = 15.0
UNLIKEST = 2.0  # what `_unlike` returns at most
HEIGHTS = 12  # at which the tip of the nose is looked for
CLOSEST = 0.8  # share of the face that has to lie on the other head


def with_landmarks(character: Character, given: Mapping[str, int] | None = None) -> tuple[Character, dict[str, float]]:
    """Return the character with every landmark of the bundled head, and how far each lies from where the fit put it, mm.

    Landmarks in `given`, vertex by name, were placed by hand: they stay, lie at 0 mm, and lead the fit of the others.
    Landmarks that the character had before and that are not in `given` are found anew. Takes about a second.

    Raises `EditError` for a name that no landmark has or a vertex outside the mesh.
    """
    placed = dict(given or {})
    for name, vertex in placed.items():
        if name not in bundled().landmarks:
            raise EditError(f"There is no landmark called {name!r}.", f"There are: {', '.join(bundled().landmarks)}.")
        if not 0 <= vertex < len(character.neutral):
            raise EditError(f"The landmark {name!r} names vertex {vertex}; the mesh has {len(character.neutral)}.")
    neutral = character.neutral.astype(np.float64)
    found, away_mm = transfer_landmarks(neutral, character.triangles, character.deltas, placed)
    return replace(character, landmarks=found), away_mm


def transfer_landmarks(
    neutral: Array, triangles: npt.NDArray[np.int32], deltas: npt.NDArray[np.float32], given: Mapping[str, int]
) -> tuple[dict[str, int], dict[str, float]]:
    """Find the bundled head's landmarks on another head in our frame: rigid fit with scale, then the nearest vertex.

    Where both heads have shapes, the fit pairs the places that move most in each (the jaw's opening finds the chin,
    a blink its lid); landmarks picked by hand take part in the fit and stay as they are. Upper and lower lip and lid
    lie at one place, so the nearest vertex is sought among those that move as the landmark does.
    """
    head = bundled()
    source = head.neutral.astype(np.float64)
    fitted = _fit(source, head, neutral, deltas, given)
    found, away = dict(given), dict.fromkeys(given, 0.0)
    skin = np.flatnonzero(skin_of(triangles, neutral, deltas))
    size = np.linalg.norm(np.ptp(source, axis=0)) / 20
    shaped = bool(deltas.any())
    for name, vertex in head.landmarks.items():
        if name in given:
            continue
        gap = np.linalg.norm(neutral[skin] - fitted[vertex], axis=1)
        near = np.flatnonzero(gap <= gap.min() + UNLIKEST * size)  # what lies further cannot be better
        unlike = _unlike(head.deltas[:, vertex], deltas[:, skin[near]]) if shaped else np.zeros(len(near))
        best = near[int(np.argmin(gap[near] + size * unlike))]
        found[name], away[name] = int(skin[best]), float(gap[best])
    return found, away


def _fit(
    source: Array,
    head: Character,
    neutral: Array,
    deltas: npt.NDArray[np.float32],
    given: Mapping[str, int],
) -> Array:
    """Return the bundled head's vertices laid onto another head, (n, 3)."""
    by_hand = [(head.landmarks[name], vertex) for name, vertex in given.items() if name in head.landmarks]
    pairs = [(source[ours], neutral[theirs]) for ours, theirs in by_hand]
    for shape in range(len(SHAPES)):
        ours, theirs = (_centre_of_motion(v, d[shape]) for v, d in ((source, head.deltas), (neutral, deltas)))
        if ours is not None and theirs is not None:
            pairs.append((ours, theirs))
    sample, tree = _sample(head, whole=bool(deltas.any())), KDTree(neutral)
    if len(pairs) >= 4:
        start, end = (np.array(side) for side in zip(*pairs, strict=True))
        best = fit_similarity(start, end[None], mirrored=False).apply(source)[0]
    else:
        tried = [_to_surface(laid, sample[::6], tree, rounds=5) for laid in _starts(source, head, neutral)]
        best = min(tried, key=lambda laid: _apart(laid[sample], tree))
    laid = _to_surface(best, sample, tree)
    return _led(laid, np.array([ours for ours, _ in by_hand], np.int64), neutral[[theirs for _, theirs in by_hand]])


def _led(laid: Array, leaders: npt.NDArray[np.int64], places: Array) -> Array:
    """Return laid-on vertices, (n, 3), shifted as those of them that have a place by hand, the more the nearer they are."""
    share = np.exp(-((cdist(laid, laid[leaders]) / LED_MM) ** 2))
    share /= np.maximum(share.sum(axis=1, keepdims=True), 1.0)
    return np.asarray(laid + share @ (places - laid[leaders]))


def _sample(head: Character, *, whole: bool) -> npt.NDArray[np.int64]:
    """Return about 1,500 vertices of the skin; not the whole of it, only what some shape moves.

    Scalp and neck differ most from head to head, but they steady a fit that starts near its end.
    """
    skin = skin_of(head.triangles, head.neutral.astype(np.float64), head.deltas)
    moved = np.linalg.norm(head.deltas, axis=2).max(axis=0) > MOVED_MM
    chosen = np.flatnonzero(skin if whole else skin & moved)
    return chosen[:: max(1, len(chosen) // 1500)]


def _starts(source: Array, head: Character, neutral: Array) -> list[Array]:
    """Return the bundled head at places from which a fit may find its way, where nothing says where the face is.

    A head is about as large as ours, in mm; its nose is the foremost place of its middle at some height.
    """
    nose = source[head.landmarks["nose_tip"]]
    middle = _middle(neutral)
    strip = neutral[np.abs(neutral[:, 0] - middle[0]) < STRIP_MM]
    laid = []
    for height in np.linspace(neutral[:, 1].min(), neutral[:, 1].max(), HEIGHTS):
        near = strip[np.abs(strip[:, 1] - height) < STRIP_MM]
        if len(near):
            tip = np.array([middle[0], height, near[:, 2].max()])
            laid += [tip + scale * (source - nose) for scale in (0.85, 1.0, 1.15)]
    return laid or [source - _middle(source) + middle]


def _apart(laid: Array, tree: KDTree) -> float:
    """Return how far most of a laid-on face is from the other head, relative to its size."""
    away = np.sort(tree.query(laid)[0])[: int(CLOSEST * len(laid))]
    return float(away.mean() / np.linalg.norm(np.ptp(laid, axis=0)))


def _to_surface(placed: Array, sample: npt.NDArray[np.int64], tree: KDTree, *, rounds: int = 12) -> Array:
    """Refine a fit by pairing vertices of the face with the nearest ones of the other head (ICP)."""
    start = moved = placed[sample]
    for _ in range(rounds):
        away, found = tree.query(moved)
        close = away <= np.percentile(away, 100 * CLOSEST)
        nearest = tree.data[np.asarray(found, np.int64)[close]]
        moved = fit_similarity(moved[close], nearest[None], mirrored=False).apply(moved)[0]
    led: Array = fit_similarity(start, moved[None], mirrored=False).apply(placed)[0]
    return led


def _middle(points: Array) -> Array:
    return np.asarray((points.min(axis=0) + points.max(axis=0)) / 2)


def _centre_of_motion(vertices: Array, delta: npt.NDArray[np.float32]) -> Array | None:
    """Return where a shape moves most, (3,); none for a shape the head has not."""
    travel = np.linalg.norm(delta, axis=1).astype(np.float64)
    if travel.max(initial=0.0) <= 0:
        return None
    share = np.where(travel > travel.max() / 2, travel, 0.0)
    return np.asarray(share @ vertices / share.sum())


def skin_of(triangles: npt.NDArray[np.int32], neutral: Array, deltas: npt.NDArray[np.float32]) -> npt.NDArray[np.bool_]:
    """Return which vertices, (n,), belong to the part of which most moves, or to the largest part where nothing does.

    A body and its clothes have more vertices than a face.
    """
    parts = parts_of(triangles, len(neutral))
    moving = np.zeros(len(neutral), bool)
    for delta in deltas:
        moving |= delta.any(axis=1)
    return np.asarray(parts == np.argmax(np.bincount(parts[moving] if moving.any() else parts)))


def _unlike(one: npt.NDArray[np.float32], many: npt.NDArray[np.float32]) -> Array:
    """Return how differently vertices move from one vertex, 0..2, for deltas (52, 3) and (52, n, 3)."""
    flat, others = one.ravel(), many.transpose(1, 0, 2).reshape(many.shape[1], -1)
    length = np.linalg.norm(others, axis=1) * np.linalg.norm(flat)
    return np.asarray(1.0 - (others @ flat) / np.maximum(length, 1e-9), np.float64)
