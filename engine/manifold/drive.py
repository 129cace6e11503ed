"""Drives a mesh without shapes by a few feature points (ZLL17 section 3.3)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp
from scipy.spatial import cKDTree

from engine.errors import EditError
from engine.manifold.patches import Indices, LabelSolver, alignment, cotangent_laplacian, rings
from engine.manifold.pose import Poses, fit_similarity
from engine.mesh import parts_of
from engine.take import Array
from engine.words import counted

FEWEST = 4
ANCHORS = 20  # points that carry a part without feature points
OPEN_SHARE = 0.12  # a part with more of its edges at a rim is a strip lying on the skin (lashes, brows), not a body


@dataclass(frozen=True)
class Settings:
    """How a mesh follows; chosen on training expressions of the second head (`retake evaluate manifold`).

    rings : patch size; two rings measured no better than one and cost three times as much
    dimension : of a patch's tangent space; 3 measured 5 % worse, as the pose that all points share is taken out first
    stiffness : cost of turning or stretching a patch, against that of leaving its local structure; with none, as in the
        paper, what lies beyond the labels is extrapolated and strays by centimetres
    curvature : cost of bending the skin, against that of leaving the patches' local structure; without it, as in the
        paper, faces stray 4 % further, and with it alone 2 %
    beta : weight of a feature point
    """

    rings: int = 1
    dimension: int = 2
    curvature: float = 10.0
    stiffness: float = 0.01
    beta: float = 1e3


class MeshDriver:
    """Moves a mesh by its feature points; factorised once for a mesh and its points, then a product for each frame.

    What all points share (rotation, mirroring, size, place) moves everything alike; what is left minimises
    ``trace(U^T B U) + curvature * |L U|^2 + beta * |U[points] - u|^2`` over the displacements U of the labelled parts, B
    of the patches (ZLL17 eq. 15) and L the cotangent Laplacian, each scaled to cost an average vertex as much. A part
    without a feature point, such as an eye or a tooth, moves rigidly with the nearest labelled part.

    Parameters
    ----------
    vertices : (n, 3), any unit
    triangles : (t, 3)
    points : (m,) vertex index of each feature point

    Raises
    ------
    EditError : fewer than four points, an index outside the mesh, a point twice, points all in one plane
    """

    def __init__(
        self,
        vertices: Array,
        triangles: npt.NDArray[np.integer],
        points: Indices,
        settings: Settings = Settings(),
    ) -> None:
        self._rest = np.asarray(vertices, np.float64)
        self._points = np.asarray(points, np.int64)
        _require_usable(self._rest, self._points)
        parts = parts_of(triangles, len(self._rest))
        labelled = np.unique(parts[self._points])
        self._solved = np.flatnonzero(np.isin(parts, labelled))
        self._influence = _influence(self._rest, triangles, self._solved, self._points, settings)
        self._rigid = _RigidParts.build(self._rest, triangles, parts, self._solved, self._points)

    @property
    def points(self) -> Indices:
        """The feature points' vertices, (m,)."""
        return self._points

    @property
    def memory_bytes(self) -> int:
        """Return the memory used between frames."""
        return int(self._influence.nbytes + self._rest.nbytes + self._solved.nbytes)

    def drive(self, positions: Array) -> Array:
        """Return the mesh, (frames, n, 3), for positions of its feature points, (frames, m, 3).

        A point that is NaN in a frame is filled from its neighbours' motion. Raises `EditError` for another number of
        points or a frame with fewer than four of them.
        """
        positions = np.asarray(positions, np.float64)
        if positions.ndim != 3 or positions.shape[1:] != (len(self._points), 3):
            raise EditError(
                f"The markers are {positions.shape[1] if positions.ndim == 3 else 0}, "
                f"the mesh has {counted(len(self._points), 'feature point')}."
            )
        return np.stack(list(self.frames(positions))) if len(positions) else np.zeros((0, *self._rest.shape))

    def frames(self, positions: Array) -> Iterator[Array]:
        """Yield what `drive` returns, (n, 3) at a time: an hour of a large mesh does not fit into memory."""
        for frame in positions:
            yield self._frame(np.asarray(frame, np.float64))

    def _frame(self, positions: Array) -> Array:
        seen = np.asarray(np.isfinite(positions).all(axis=1))
        rest = self._rest[self._points]
        if seen.sum() < FEWEST:
            raise EditError(
                f"A frame has only {int(seen.sum())} of {counted(len(seen), 'marker')}.", "Fill the gaps first."
            )
        pose = fit_similarity(rest[seen], positions[None, seen])
        moved = np.zeros((len(rest), 3))
        moved[seen] = pose.undo(positions[None, seen])[0] - rest[seen]
        if not seen.all():
            moved[~seen] = _from_neighbours(rest, moved, seen)
        return self._place(moved, pose)

    def _place(self, moved: Array, pose: Poses) -> Array:
        posed = self._rest.copy()
        posed[self._solved] += (moved.T @ self._influence.T).T  # this way round no threads are woken
        self._rigid.carry(posed, self._rest)
        posed = posed @ (pose.scale[0] * pose.turn[0])
        return np.asarray(posed + pose.shift[0])


def _require_usable(rest: Array, points: Indices) -> None:
    if not np.isfinite(rest).all():
        raise EditError("The mesh has a vertex that is not at a finite place.")
    if len(points) < FEWEST:
        raise EditError(
            f"{counted(len(points), 'feature point')}: too few to drive a mesh.", "Pick at least four, better 80."
        )
    if points.min() < 0 or points.max() >= len(rest):
        raise EditError(f"A feature point names vertex {points.max()}; the mesh has {len(rest)}.")
    values, counts = np.unique(points, return_counts=True)
    if counts.max() > 1:
        raise EditError(
            f"Vertex {values[counts.argmax()]} is a feature point twice.",
            "Give each point a vertex of its own; on a mesh with few vertices, name fewer points in a marker,vertex file.",
        )
    spread = np.linalg.svd(rest[points] - rest[points].mean(axis=0), compute_uv=False)
    if spread[2] < 1e-6 * spread[0]:
        raise EditError(
            "All feature points lie in one plane.", "Add points in front of or behind it: nose, chin, ears."
        )


def _influence(
    rest: Array, triangles: npt.NDArray[np.integer], solved: Indices, points: Indices, settings: Settings
) -> Array:
    """Return the matrix from feature points to vertices of the labelled parts, (solved, m)."""
    place = np.full(len(rest), -1)
    place[solved] = np.arange(len(solved))
    local = place[triangles[(place[triangles] >= 0).all(axis=1)]]
    neighbourhoods = rings(local, rest[solved], size=settings.rings)
    energy = _normalised(
        alignment(rest[solved], neighbourhoods, dimension=settings.dimension, stiffness=settings.stiffness)
    )
    if settings.curvature:
        laplacian = cotangent_laplacian(rest[solved], local)
        energy = (energy + settings.curvature * _normalised(sp.csc_array(laplacian.T @ laplacian))).tocsc()
    return LabelSolver(energy, place[points], beta=settings.beta).influence()


def _normalised(energy: sp.csc_array) -> sp.csc_array:
    """Normalise an energy to a mean diagonal of 1."""
    return sp.csc_array(energy * (energy.shape[0] / max(float(energy.diagonal().sum()), 1e-300)))


def _from_neighbours(rest: Array, moved: Array, seen: npt.NDArray[np.bool_]) -> Array:
    """Return displacements of unseen points as the mean of the three nearest seen ones, by inverse distance."""
    away, nearest = cKDTree(rest[seen]).query(rest[~seen], k=3)
    share = 1.0 / np.maximum(away, 1e-9)
    share /= share.sum(axis=1, keepdims=True)
    return np.asarray(np.einsum("nk,nkd->nd", share, moved[seen][nearest]))


@dataclass(frozen=True, eq=False)
class _RigidParts:
    """Moves parts without feature points rigidly with anchors.

    A strip such as lashes follows the skin that it lies on; a body such as an eye or a tooth by the feature points
    round it, of which the lids and lips are the few that the fit leaves out.

    Attributes
    ----------
    anchors : (parts, ANCHORS) vertices that carry each part
    members : the vertices of each carried part
    """

    anchors: Indices
    members: tuple[Indices, ...]

    @staticmethod
    def build(
        rest: Array, triangles: npt.NDArray[np.integer], parts: Indices, solved: Indices, points: Indices
    ) -> _RigidParts:
        """Choose the anchors of each part."""
        names = np.setdiff1d(parts, parts[solved])
        if not len(names):
            return _RigidParts(np.zeros((0, ANCHORS), np.int64), ())
        members = tuple(np.flatnonzero(parts == name) for name in names)
        strips = _open_share(triangles, parts) > OPEN_SHARE
        anchors = np.zeros((len(names), ANCHORS), np.int64)
        skin, leading = cKDTree(rest[solved]), cKDTree(rest[points])
        for index, (name, own) in enumerate(zip(names, members, strict=True)):
            if strips[name]:
                candidates = solved[np.unique(skin.query(rest[own])[1])]
            else:
                candidates = points[leading.query(rest[own].mean(axis=0), k=min(ANCHORS, len(points)))[1]]
            anchors[index] = candidates[np.linspace(0, len(candidates) - 1, ANCHORS).round().astype(int)]
        return _RigidParts(anchors, members)

    def carry(self, posed: Array, rest: Array) -> None:
        """Move the carried parts of `posed`, (n, 3), with their anchors, in place."""
        if not self.members:
            return
        motion = fit_similarity(rest[self.anchors], posed[self.anchors], scaled=False, mirrored=False)
        for own, turn, shift in zip(self.members, motion.turn, motion.shift, strict=True):
            posed[own] = rest[own] @ turn + shift


def _open_share(triangles: npt.NDArray[np.integer], parts: Indices) -> Array:
    """Return the share of each part's edges that belong to one triangle only, (parts,)."""
    count = int(parts.max()) + 1
    edges = np.sort(
        np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2).astype(np.int64), axis=1
    )
    unique, uses = np.unique(edges[:, 0] * len(parts) + edges[:, 1], return_counts=True)
    part = parts[unique // len(parts)]
    total = np.bincount(part, minlength=count)
    return np.asarray(np.bincount(part, uses == 1, minlength=count) / np.maximum(total, 1))


def aim(points_rest: Array, source_rest: Array, displacements: Array) -> tuple[Array, Poses]:
    """Return targets of feature points, (frames, m, 3), from another face's markers, and the similarity onto the mesh.

    The source's displacements are rotated and scaled like its face at rest onto the mesh; the head stays still.

    Parameters
    ----------
    points_rest : (m, 3) the feature points on the mesh at rest
    source_rest : (m, 3) the same points of the source at rest
    displacements : (frames, m, 3) of the source's markers, the head's motion taken out; NaN where one was not seen
    """
    laid = fit_similarity(source_rest, points_rest[None], mirrored=False)
    return np.asarray(points_rest + laid.scale[0] * (displacements @ laid.turn[0])), laid
