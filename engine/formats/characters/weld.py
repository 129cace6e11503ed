"""Vertices that a file has several times, once for each face or seam, made one: a head hangs together by its vertices."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from engine.formats.characters.raw import RawCharacter
from engine.take import Array

SAME = 1e-6  # of the mesh's extent: how near two places, or two motions, are one; files are good to 6 digits
Indices = npt.NDArray[np.int32]


def welded(raw: RawCharacter) -> RawCharacter:
    """Return the mesh with vertices of equal place and equal motion in every shape as one; `split` leads back.

    Only vertices at a rim are joined: each face of a flat-shaded export has its own, and so have both sides of a seam
    in the texture. Lips and lids that touch are no rim, or move apart, and stay two. A mesh without such vertices comes back
    as it is. Time and memory grow with the vertices, whatever the number of parts.
    """
    tolerance = max(SAME * float(np.ptp(raw.vertices, axis=0).max()), 1e-300)
    keys = np.empty((len(raw.vertices), 6))
    keys[:, :3] = np.round(raw.vertices / tolerance)
    keys[:, 3:5] = _motion_keys(raw, tolerance)
    keys[:, 5] = np.where(_at_rim(raw.triangles, len(keys)), -1, np.arange(len(keys)))
    split, kept = _numbered(keys)
    if len(kept) == len(keys):
        return raw
    triangles = split[raw.triangles]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    if not len(triangles):
        return raw
    shapes = {name: delta[kept] for name, delta in raw.shapes.items()}
    return replace(
        raw,
        vertices=raw.vertices[kept],
        triangles=triangles,
        shapes=shapes,
        split=split,
        split_triangles=raw.triangles,
    )


SMALLEST = 1e-12  # of a tolerance: nothing that is drawn is as small


def _motion_keys(raw: RawCharacter, tolerance: float) -> Array:
    """Return two numbers for each vertex, (n, 2), that are equal where all its motions are, to within rounding.

    Each is a sum with weights of its own for each coordinate of each shape: a fingerprint, taken shape by shape.
    """
    keys = np.zeros((len(raw.vertices), 2))
    rng = np.random.default_rng(0)
    for delta in raw.shapes.values():
        moving = np.flatnonzero(delta.any(axis=1))
        rounded = np.round(delta[moving].astype(np.float64) / max(tolerance, SMALLEST))
        keys[moving] += rounded @ rng.integers(1, 1 << 20, size=(3, 2)).astype(np.float64)  # whole numbers: exact
    return keys


def _at_rim(triangles: npt.NDArray[np.int32], vertices: int) -> npt.NDArray[np.bool_]:
    """Return which vertices, (vertices,), have an edge that belongs to one triangle only."""
    ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    edges = np.sort(ends, axis=1).astype(np.int64)
    packed = edges[:, 0] * vertices + edges[:, 1]
    unique, uses = np.unique(packed, return_counts=True)
    open_ = unique[uses == 1]
    rim = np.zeros(vertices, bool)
    rim[open_ // vertices] = rim[open_ % vertices] = True
    return rim


def _numbered(keys: Array) -> tuple[Indices, npt.NDArray[np.int64]]:
    """Return a number for each row of keys, (n, k), equal rows alike, in the order of first sight; and the first of each."""
    order = np.lexsort(keys.T)
    fresh = np.ones(len(keys), bool)
    fresh[1:] = (keys[order[1:]] != keys[order[:-1]]).any(axis=1)
    group = np.empty(len(keys), np.int64)
    group[order] = np.cumsum(fresh) - 1
    first = np.full(int(fresh.sum()), len(keys))
    np.minimum.at(first, group, np.arange(len(keys)))
    by_sight = np.argsort(first)
    rank = np.empty(len(first), np.int32)
    rank[by_sight] = np.arange(len(first), dtype=np.int32)
    return rank[group], first[by_sight]
