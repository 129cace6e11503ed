"""Where feature points should sit on a face: spread by how differently it moves, not by how large it is."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp
from scipy.sparse import csgraph

from engine.errors import EditError
from engine.manifold.patches import Indices
from engine.mesh import adjacency
from engine.take import Array
from engine.words import counted

SPACE_SHARE = 0.08  # mm of motion that one mm along the skin counts for; far less bares the brow, far more the lips


def place_points(
    vertices: Array,
    triangles: npt.NDArray[np.integer],
    motions: Array,
    count: int,
    *,
    allowed: npt.NDArray[np.bool_] | None = None,
) -> Indices:
    """Return `count` vertices so that no vertex moves very differently from a chosen one near it on the mesh.

    Farthest-point sampling along the mesh, an edge being as long as the root mean square difference between the motions
    of its ends, plus a share of its length.

    Parameters
    ----------
    vertices : (n, 3), mm
    motions : (samples, n, 3), mm, displacements of the mesh in typical expressions
    allowed : (n,) where points may sit, such as the skin; everywhere when absent

    Raises
    ------
    EditError : where fewer vertices are allowed than points asked for
    """
    where = np.ones(len(vertices), bool) if allowed is None else allowed
    if count > where.sum():
        raise EditError(
            f"{counted(count, 'feature point')} cannot be placed on {counted(int(where.sum()), 'vertex', 'vertices')}."
        )
    edges = adjacency(triangles, len(vertices)).tocoo()
    start, end = edges.row, edges.col
    unlike = np.sqrt(((motions[:, start] - motions[:, end]) ** 2).sum(axis=2).mean(axis=0))
    length = unlike + SPACE_SHARE * np.linalg.norm(vertices[start] - vertices[end], axis=1) + 1e-9
    graph = sp.csr_array((length, (start, end)), shape=edges.shape)
    still = np.where(where, (motions**2).sum(axis=(0, 2)), np.inf)
    chosen = [int(np.argmin(still))]
    away = _along(graph, chosen[0])
    while len(chosen) < count:
        away[~where] = -1.0
        chosen.append(int(np.argmax(np.where(np.isfinite(away), away, 1e12))))
        away = np.minimum(np.where(where, away, np.inf), _along(graph, chosen[-1]))
    return np.array(chosen)


def _along(graph: sp.csr_array, start: int) -> Array:
    """Return the shortest way along the mesh from one vertex to each, (n,)."""
    dijkstra: Any = csgraph.dijkstra  # its stub leaves out what it has always taken
    return np.asarray(dijkstra(graph, indices=start), np.float64)
