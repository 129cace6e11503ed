"""Alignment of local patches of a data set, and its solve for a few given data points (ZLL17 section 3.1)."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

from engine.errors import EditError
from engine.mesh import adjacency
from engine.take import Array

Indices = npt.NDArray[np.int64]
FLAT = 1e-7  # a direction this much thinner than the widest is one that the patch does not have
CENTRE_SHARE = 10.0  # weight of a patch's own vertex against all its neighbours together: ten heads of the second set
COLUMNS = 16  # solved at a time: with one BLAS thread, as the app sets, 20 % faster than four; more gain nothing
PANEL = 8  # columns factorised at a time: 8 % faster than SuperLU's default at a mesh's few entries a column
REACH = 2.0  # neighbours count by distance to the power of minus this
NEAR = 0.05  # of a patch's mean distance: nearer points get no larger weight, or a constant pose would form a patch of its own
COTANGENTS = (1e-3, 10.0)  # half of them, of a triangle's angles
CHUNK_ENTRIES = 1 << 20  # of patch matrices that are in memory at a time
Progress = Callable[[float], None]  # is called with the share that is done, 0..1; it may raise, to stop


def ignore(_: float) -> None:
    """Ignore the progress."""


def rings(triangles: npt.NDArray[np.integer], points: Array, *, size: int = 1) -> sp.csr_array:
    """Return each vertex's neighbourhood: itself and `size` rings of the mesh, never what merely lies near.

    The entries are weights: near neighbours count more, the vertex itself most. A row is one patch of `alignment`.
    """
    ring = (adjacency(triangles, len(points)) + sp.eye_array(len(points))).tocsr()
    reached = ring
    for _ in range(size - 1):
        reached = (reached @ ring).tocsr()
    reached.sort_indices()
    return _weighted(reached, points)


def similar(points: Array, *, size: int) -> sp.csr_array:
    """Return each data point's neighbourhood: itself and the `size` - 1 points most like it, weighted as `rings`.

    Of frames these are the ones just before and after, and those where the face comes by again.
    """
    size = min(size, len(points))
    if size == 1:
        return sp.eye_array(1, format="csr")
    nearest: Indices = np.asarray(cKDTree(points).query(points, k=size)[1], np.int64)
    missed = ~(nearest == np.arange(len(points))[:, None]).any(axis=1)  # among more equals than `size`
    nearest[missed, -1] = np.flatnonzero(missed)
    nearest.sort(axis=1)
    starts = np.arange(len(points) + 1) * size
    return _weighted(sp.csr_array((np.ones(nearest.size), nearest.ravel(), starts), shape=2 * (len(points),)), points)


def windows(frames: int, *, size: int) -> sp.csr_array:
    """Return each frame's neighbourhood in time: `size` consecutive frames around it, shifted inwards at the ends."""
    size = min(size, frames)
    first = np.clip(np.arange(frames) - size // 2, 0, frames - size)
    members = first[:, None] + np.arange(size)
    starts = np.arange(frames + 1) * size
    return sp.csr_array((np.ones(members.size), members.ravel(), starts), shape=(frames, frames))


def _weighted(pattern: sp.csr_array, points: Array) -> sp.csr_array:
    """Return the pattern with weights ``distance^-REACH``, and `CENTRE_SHARE` times their sum for a patch's own point."""
    count = len(points)
    row = np.repeat(np.arange(count), np.diff(pattern.indptr))
    own = row == pattern.indices
    away = np.linalg.norm(points[row] - points[pattern.indices], axis=1)
    nearest = np.full(count, np.inf)
    np.minimum.at(nearest, row, np.where(away > 0, away, np.inf))
    typical = np.bincount(row, away, minlength=count) / np.maximum(np.diff(pattern.indptr) - 1, 1)
    closest = np.where(np.isfinite(nearest), np.maximum(nearest, NEAR * typical), 1.0)[row]
    falloff = np.where(own, 0.0, (closest / np.maximum(away, closest)) ** REACH)
    total = np.maximum(np.bincount(row, falloff, minlength=count), 1e-12)
    weights = np.where(own, CENTRE_SHARE * total[row], falloff)
    return sp.csr_array((weights, pattern.indices, pattern.indptr), shape=(count, count))


def alignment(
    points: Array,
    neighbourhoods: sp.csr_array,
    *,
    dimension: int = 3,
    stiffness: float = 0.0,
    progress: Progress = ignore,
) -> sp.csc_array:
    """Return B of ZLL17 equation 15, the energy of leaving the local structure of `points`.

    ``trace(Y^T B Y) = sum_i min_{D_i, c_i} |q_i (Y_i - X_i~ D_i - c_i)|^2 + stiffness * s_i^2 |D_i|^2`` with X_i~ the
    tangent coordinates of patch i (local PCA), q_i the roots of its neighbours' weights, and s_i its largest extent.
    With no stiffness every affine motion of a patch is free, as in the paper; with some, Y should be a displacement, and
    patches are penalised for rotating or stretching.

    Parameters
    ----------
    points : (n, D) data points
    neighbourhoods : (n, n) weights; row i holds the members of patch i
    dimension : of the tangent space; directions that a patch does not have are left out
    progress : called with the share that is done
    """
    rows, columns, values = zip(*_scattered(points, neighbourhoods, dimension, stiffness, progress), strict=True)
    places = (np.concatenate(rows), np.concatenate(columns))
    count = len(points)
    return sp.coo_array((np.concatenate(values), places), shape=(count, count)).tocsc()


def _scattered(
    points: Array, neighbourhoods: sp.csr_array, dimension: int, stiffness: float, progress: Progress
) -> Iterator[tuple[npt.NDArray[np.integer], npt.NDArray[np.integer], Array]]:
    """Yield rows, columns and values of the patches' matrices, some patches of one size at a time."""
    sizes = np.diff(neighbourhoods.indptr)
    done = 0
    for size in np.unique(sizes[sizes > 0]):
        alike = np.flatnonzero(sizes == size)
        for patches in np.array_split(alike, -(-len(alike) * int(size) ** 2 // CHUNK_ENTRIES)):
            progress(done / len(sizes))
            done += len(patches)
            entries = neighbourhoods.indptr[patches][:, None] + np.arange(size)
            members = neighbourhoods.indices[entries]
            local = _patch_matrices(points[members], neighbourhoods.data[entries], dimension, stiffness)
            yield np.repeat(members, size, axis=1).ravel(), np.tile(members, (1, size)).ravel(), local.ravel()


def _patch_matrices(members: Array, weights: Array, dimension: int, stiffness: float) -> Array:
    """Return I - G G^T of Algorithm 1, (patches, size, size), for members (patches, size, D) and their weights."""
    weights = weights / weights.mean(axis=1, keepdims=True)
    root = np.sqrt(weights)
    mean = np.einsum("pk,pkd->pd", weights, members) / weights.sum(axis=1)[:, None]
    centred = root[:, :, None] * (members - mean[:, None])
    narrow = stiffness > 0 and centred.shape[2] < centred.shape[1]
    tangent = (_stiff_tangents if narrow else _tangents)(centred, dimension, stiffness)
    constant = root / np.linalg.norm(root, axis=1, keepdims=True)
    free = np.concatenate([constant[:, :, None], tangent], axis=2) * root[:, :, None]
    cost = -free @ free.transpose(0, 2, 1)
    own = np.arange(root.shape[1])
    cost[:, own, own] += weights
    return np.asarray(cost)


def _tangents(centred: Array, dimension: int, stiffness: float) -> Array:
    """Return orthogonal directions (patches, size, d) in which a patch moves freely, scaled by their cost."""
    tangent, extent, _ = np.linalg.svd(centred, full_matrices=False)
    tangent, extent = tangent[:, :, :dimension], extent[:, :dimension]
    widest = np.maximum(extent[:, :1], 1e-300)
    share = extent**2 / np.maximum(extent**2 + stiffness * widest**2, 1e-300)
    return np.asarray(tangent * np.sqrt(np.where(extent > FLAT * widest, share, 0.0))[:, None, :])


def _stiff_tangents(centred: Array, dimension: int, stiffness: float) -> Array:
    """Return `_tangents` from the (D, D) products: half the time, and as exact, as no thin extent is divided by."""
    squared, axes = np.linalg.eigh(centred.transpose(0, 2, 1) @ centred)
    squared, axes = np.maximum(squared[:, None, -dimension:], 0.0), axes[:, :, -dimension:]
    return np.asarray(centred @ (axes / np.sqrt(np.maximum(squared + stiffness * squared[:, :, -1:], 1e-300))))


def cotangent_laplacian(rest: Array, triangles: npt.NDArray[np.integer]) -> sp.csr_array:
    """Return the cotangent Laplacian, (n, n), whose rows are a mesh's differential coordinates (Sorkine 2004).

    Obtuse angles count a little instead of pushing away, slivers no more than an angle of three degrees.
    """
    corner = rest[triangles]
    ahead = np.roll(corner, -1, axis=1) - corner
    area = np.linalg.norm(np.cross(ahead[:, 0], ahead[:, 1]), axis=1, keepdims=True)
    cosine = -(ahead * np.roll(ahead, 1, axis=1)).sum(axis=2)
    weight = np.clip(0.5 * cosine / np.maximum(area, 1e-300), *COTANGENTS)  # of the edge across from each corner
    places = (np.roll(triangles, -1, axis=1).ravel(), np.roll(triangles, -2, axis=1).ravel())
    half = sp.coo_array((weight.ravel(), places), shape=2 * (len(rest),)).tocsr()
    joined = half + half.T
    return sp.csr_array(sp.diags_array(np.asarray(joined.sum(axis=1)).ravel()) - joined)


class LabelSolver:
    """Solves for every data point from a few labelled ones (ZLL17 equation 18), factorised once.

    Minimises ``trace(Y^T B Y) + beta * |Y[labelled] - labels|^2`` by the sparse system ``(B + beta S) Y = beta S labels``.

    Parameters
    ----------
    energy : (n, n) sparse, B
    labelled : (m,) indices of the labelled data points
    beta : weight of a label, one for all or (m,)

    Raises
    ------
    EditError : where the labels leave some data point free
    """

    def __init__(self, energy: sp.csc_array, labelled: Indices, *, beta: float | Array = 1e3) -> None:
        count = energy.shape[0]
        self._labelled, self._count = labelled, count
        self._beta = np.broadcast_to(np.asarray(beta, np.float64), len(labelled))
        selected = sp.coo_array((self._beta, (labelled, labelled)), shape=(count, count))
        system = (energy + selected).tocsc()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                self._factor = splu(
                    system,
                    permc_spec="MMD_AT_PLUS_A",
                    panel_size=PANEL,
                    diag_pivot_thresh=0.0,
                    options={"SymmetricMode": True},
                )
        except (RuntimeError, Warning) as error:
            raise _undetermined() from error
        # A shift of everything costs nothing, so equal labels give equal points: unless others are free as well.
        if not np.allclose(self.solve(np.ones((len(labelled), 1))), 1.0, atol=1e-5):
            raise _undetermined()

    def solve(self, labels: Array) -> Array:
        """Return all data points, (n, k), for labels (m, k)."""
        right = np.zeros((self._count, labels.shape[1]))
        np.add.at(right, self._labelled, self._beta[:, None] * labels)
        parts = [self._factor.solve(right[:, k : k + COLUMNS]) for k in range(0, right.shape[1], COLUMNS)]
        return np.concatenate(parts, axis=1) if parts else right

    def influence(self) -> Array:
        """Return the matrix from labels to data points, (n, m), with which a solve is one product."""
        return self.solve(np.eye(len(self._labelled)))

    def uncertainty(self) -> Array:
        """Return the uncertainty of each data point, (n,): the root of the diagonal of ``(B + beta S)^-1``.

        Were the energy a likelihood, this would be each point's standard deviation up to a common factor.
        """
        spread = np.empty(self._count)
        for start in range(0, self._count, COLUMNS):
            columns = np.arange(start, min(start + COLUMNS, self._count))
            right = np.zeros((self._count, len(columns)))
            right[columns, columns - start] = 1.0
            spread[columns] = self._factor.solve(right)[columns, columns - start]
        return np.sqrt(np.maximum(spread, 0.0))


def _undetermined() -> EditError:
    return EditError(
        "The labels do not determine the result.", "Label more frames or points, not all of them in a line."
    )
