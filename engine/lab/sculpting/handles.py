"""Handles: some seventy named places of the skin whose motion, interpolated over the rest, makes a shape."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse.linalg import splu

from engine.lab.sculpting.lips import POINTS
from engine.lab.sculpting.sculpture import Sculpture
from engine.take import Array, Mask

Indices = npt.NDArray[np.int64]
LIP_RINGS = (2, 4, 8)  # beside the lips, their border, where they touch
LIP_PLACES = (*range(12, 25, 2), *range(26, 37, 2))  # the left half, from the middle of the upper lip round the corner
BESIDE_PLACES = (12, 16, 20, 24, 28, 32, 36)
FOLLOWS = {
    9: 0.97,
    10: 0.9,
    11: 0.75,
    12: 0.45,
    13: 0.2,
    14: 0.1,
    15: 0.05,
}  # how far the inside of the mouth goes along
# Places of the left half of the face and its middle, (x, y) in cm seen from the front.
FACE: dict[str, tuple[float, float]] = {
    "bridge": (0, 0.0), "back of the nose": (0, -1.8), "tip": (0, -3.6), "columella": (0, -4.95),
    "wing": (1.75, -3.8), "above the wing": (1.5, -2.7), "side of the nose": (1.15, -1.2), "behind the wing": (2.2, -4.5),
    "fold": (2.5, -5.5), "fold below": (3.3, -6.4), "mouth pouch": (3.4, -8.0),
    "under the eye, in": (1.9, -1.5), "under the eye": (3.2, -1.75), "under the eye, out": (4.6, -1.3),
    "cheek, in": (2.8, -3.0), "cheek": (4.2, -3.0), "cheekbone": (5.7, -2.6), "cheek, low": (3.9, -4.8), "cheek, out": (5.4, -5.2),
    "jowl": (4.9, -7.4), "jaw": (4.2, -9.3), "jaw, front": (2.7, -10.9), "chin fold": (0, -9.0), "beside the chin": (1.5, -9.4),
    "chin": (0, -10.5), "under the chin": (0, -11.75),
    "brow, in": (1.35, 1.75), "brow": (2.9, 2.15), "brow, out": (4.5, 1.85), "brow, tail": (5.7, 0.9),
    "between the brows": (0, 1.7),
    "above the brow, in": (1.4, 3.4), "above the brow": (3.2, 3.6), "above the brow, out": (5.2, 3.2), "forehead": (0, 5.0),
    "forehead, out": (3.2, 5.6), "eye corner, out": (5.6, -0.3), "temple": (6.9, 1.0), "nose root": (1.2, 0.6),
}  # fmt: skip
MIDDLE_CM = 0.02


@dataclass(frozen=True, eq=False)
class Handles:
    """The handles of a sculpture, those of the left half first, then their mirror images.

    Attributes
    ----------
    names : of the left half and the middle
    vertices : (2 h,) skin vertex of each; those of the middle stand twice
    basis : (skin, distinct) influence of each distinct handle on the skin
    distinct : (2 h,) column of the basis of each handle
    """

    names: tuple[str, ...]
    vertices: Indices
    basis: Array
    distinct: Indices

    def motion(self, moves: Array) -> Array:
        """Return the motion of the skin, (skin, 3), by moves of all handles, (2 h, 3)."""
        values = np.zeros((self.basis.shape[1], 3))
        values[self.distinct] = moves
        return np.asarray(self.basis @ values)


def named(head: Sculpture) -> dict[str, int]:
    """Return the handles of the left half and the middle: vertices of the skin by name."""
    mouth = head.topology.mouth
    places = {f"lip {ring} {place}": mouth[ring][place] for ring in LIP_RINGS[1:] for place in LIP_PLACES}
    places |= {f"lip {LIP_RINGS[0]} {place}": mouth[LIP_RINGS[0]][place] for place in BESIDE_PLACES}
    outer = np.flatnonzero((head.ring < 1) & (head.lid < 2) & (head.skin[:, 2] > 0))
    for name, (x, y) in FACE.items():
        seen = head.skin[outer]
        away = (seen[:, 0] - x) ** 2 + (seen[:, 1] - y) ** 2 + 1e-3 * np.maximum(0, 8 - seen[:, 2])
        away[(x == 0) & (np.abs(seen[:, 0]) > MIDDLE_CM)] = np.inf
        places[name] = int(outer[away.argmin()])
    return places


def of(head: Sculpture) -> Handles:
    """Return the handles of a sculpture and their influence.

    The influence minimises ``sum |L u|^2``, L the Laplacian by inverse edge lengths, with 1 at the handle, 0 at all
    others, and 0 behind, on the neck and on the lids (Botsch and Kobbelt 2004, biharmonic deformation).
    """
    places = named(head)
    left = np.array(list(places.values()))
    every = np.concatenate([left, head.mirror[left]])
    unique, distinct = np.unique(every, return_inverse=True)
    basis = _biharmonic(head, unique, _still(head))
    return Handles(tuple(places), every, _into_the_mouth(head, basis), distinct)


def _still(head: Sculpture) -> Mask:
    """Return which vertices no handle moves: the back of the head, the neck's floor, the lids' inner rings."""
    points = head.skin
    behind = points[:, 2] < 0.8
    return behind | (points[:, 1] < -15.5) | (head.lid >= 4) | (points[:, 1] > 9.0)


def _laplacian(head: Sculpture) -> sparse.csr_array:
    count = len(head.skin)
    triangles = head.triangles[(head.triangles < count).all(axis=1)]
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    ends = np.unique(np.sort(ends, axis=1), axis=0)
    weight = 1.0 / np.maximum(np.linalg.norm(head.skin[ends[:, 0]] - head.skin[ends[:, 1]], axis=1), 0.03)
    one_way = sparse.coo_array((weight, (ends[:, 0], ends[:, 1])), shape=(count, count))
    joined = sparse.csr_array(one_way + one_way.T)
    return sparse.csr_array(sparse.diags_array(np.asarray(joined.sum(axis=1)).ravel()) - joined)


def _biharmonic(head: Sculpture, handles: Indices, still: Mask) -> Array:
    laplacian = _laplacian(head)
    energy = sparse.csc_array(laplacian.T @ laplacian) + 1e-9 * sparse.eye_array(len(head.skin), format="csc")
    fixed = still.copy()
    fixed[handles] = True
    free = np.flatnonzero(~fixed)
    basis = np.zeros((len(head.skin), len(handles)))
    basis[handles, np.arange(len(handles))] = 1.0
    basis[free] = splu(energy[free][:, free].tocsc()).solve(-(energy[free][:, handles] @ np.eye(len(handles))))
    return basis


def _into_the_mouth(head: Sculpture, basis: Array) -> Array:
    """Let the inside of the mouth follow the line where the lips touch."""
    basis = basis.copy()
    contact = head.topology.mouth[8]
    for ring, share in FOLLOWS.items():
        loop = head.topology.mouth[ring]
        assert len(loop) == POINTS
        basis[loop] = share * basis[contact]
    basis[head.topology.mouth[-1]] = 0.0
    return basis
