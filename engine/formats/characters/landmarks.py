"""Landmarks from the bundled head to another one: a rigid fit with scale, then the nearest vertex that moves alike."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy.spatial import KDTree

from engine.character import Character, bundled
from engine.errors import EditError
from engine.manifold.drive import parts_of
from engine.manifold.pose import fit_similarity
from engine.take import SHAPES, Array


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
    skin = np.flatnonzero(_largest_part(triangles, len(neutral)))
    size = np.linalg.norm(np.ptp(source, axis=0)) / 20
    for name, vertex in head.landmarks.items():
        if name in given:
            continue
        gap = np.linalg.norm(neutral[skin] - fitted[vertex], axis=1)
        unlike = _unlike(head.deltas[:, vertex], deltas[:, skin]) if np.abs(deltas).any() else np.zeros(len(skin))
        best = int(np.argmin(gap + size * unlike))
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
    pairs = [
        (source[head.landmarks[name]], neutral[vertex]) for name, vertex in given.items() if name in head.landmarks
    ]
    for shape in range(len(SHAPES)):
        ours, theirs = (_centre_of_motion(v, d[shape]) for v, d in ((source, head.deltas), (neutral, deltas)))
        if ours is not None and theirs is not None:
            pairs.append((ours, theirs))
    if len(pairs) >= 4:
        start, end = (np.array(side) for side in zip(*pairs, strict=True))
        placed = fit_similarity(start, end[None], mirrored=False).apply(source)[0]
    else:
        scale = np.ptp(neutral[:, 1]) / np.ptp(source[:, 1])
        placed = (source - _middle(source)) * scale + _middle(neutral)
    return _to_surface(placed, np.flatnonzero(_largest_part(head.triangles, len(source))), neutral)


def _to_surface(placed: Array, skin: npt.NDArray[np.int64], neutral: Array, *, rounds: int = 12) -> Array:
    """Refine a fit by pairing each vertex of the skin with the nearest one of the other head (ICP)."""
    tree = KDTree(neutral)
    sample = placed[skin[:: max(1, len(skin) // 1500)]]
    laid = placed
    for _ in range(rounds):
        away, found = tree.query(sample)
        nearest = np.asarray(found, np.int64)
        close = away <= np.percentile(away, 80)
        motion = fit_similarity(sample[close], neutral[nearest[close]][None], mirrored=False)
        sample, laid = motion.apply(sample)[0], motion.apply(laid)[0]
    return laid


def _middle(points: Array) -> Array:
    return np.asarray((points.min(axis=0) + points.max(axis=0)) / 2)


def _centre_of_motion(vertices: Array, delta: npt.NDArray[np.float32]) -> Array | None:
    """Return where a shape moves most, (3,); none for a shape the head has not."""
    travel = np.linalg.norm(delta, axis=1).astype(np.float64)
    if travel.max(initial=0.0) <= 0:
        return None
    share = np.where(travel > travel.max() / 2, travel, 0.0)
    return np.asarray(share @ vertices / share.sum())


def _largest_part(triangles: npt.NDArray[np.int32], vertices: int) -> npt.NDArray[np.bool_]:
    parts = parts_of(triangles, vertices)
    return np.asarray(parts == np.argmax(np.bincount(parts)))


def _unlike(one: npt.NDArray[np.float32], many: npt.NDArray[np.float32]) -> Array:
    """Return how differently vertices move from one vertex, 0..2, for deltas (52, 3) and (52, n, 3)."""
    flat, others = one.ravel(), many.transpose(1, 0, 2).reshape(many.shape[1], -1)
    length = np.linalg.norm(others, axis=1) * np.linalg.norm(flat)
    return np.asarray(1.0 - (others @ flat) / np.maximum(length, 1e-9), np.float64)
