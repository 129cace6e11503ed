"""Markers onto a head from a few that were placed by hand: a fit with scale, then the nearest point of the skin."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.spatial import KDTree
from scipy.spatial.distance import cdist

from engine.character import Character
from engine.errors import EditError
from engine.manifold.pose import fit_similarity
from engine.mesh import parts_of
from engine.spacetime.align import check_points
from engine.take import Array
from engine.words import counted

FEWEST = 4


def place_rest(points: Array, names: Sequence[str], character: Character, given: Mapping[str, int]) -> dict[str, int]:
    """Return a vertex for every marker: those given stay, the others follow them.

    The similarity that carries the given markers onto their vertices carries the others, corrected by what it misses at
    the given ones, the nearer the more; each then goes to the nearest vertex of the head's largest part that is free.

    Parameters
    ----------
    points : (n, 3) mm, the markers on the source's face at rest
    names : of the markers
    character : the head they are placed on
    given : vertex by name of those that were placed by hand

    Raises
    ------
    EditError : where fewer than four are given, or they lie in one plane
    """
    placed = [name for name in names if name in given]
    if len(placed) < FEWEST:
        raise EditError(
            f"{counted(len(placed), 'marker')} placed by hand; the others follow from four.",
            "Place some far apart: a brow, the tip of the nose, a mouth corner, the chin.",
        )
    rows = [names.index(name) for name in placed]
    check_points(points[rows], placed)
    rest = character.neutral.astype(np.float64)
    goals = rest[[given[name] for name in placed]]
    laid = fit_similarity(points[rows], goals[None], mirrored=False).apply(points)[0]
    missed = goals - laid[rows]
    near = 1.0 / np.maximum(cdist(laid, laid[rows]), 1e-6) ** 2
    laid += near @ missed / near.sum(axis=1, keepdims=True)
    return {**_nearest(laid, names, character, rest, given), **{name: given[name] for name in placed}}


def _nearest(
    laid: Array, names: Sequence[str], character: Character, rest: Array, given: Mapping[str, int]
) -> dict[str, int]:
    """Return the nearest vertex of the skin for each marker, no vertex twice."""
    parts = parts_of(character.triangles, len(rest))
    skin = np.flatnonzero(parts == np.argmax(np.bincount(parts)))
    _, order = KDTree(rest[skin]).query(laid, k=min(len(names) + 1, len(skin)))
    found: dict[str, int] = {}
    taken = set(given.values())
    for name, near in zip(names, np.asarray(order).reshape(len(names), -1), strict=True):
        if name not in given:
            found[name] = next((int(v) for v in skin[near] if int(v) not in taken), int(skin[near[0]]))
            taken.add(found[name])
    return found
