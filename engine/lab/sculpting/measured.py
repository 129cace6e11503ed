"""What is measured on a sculpted or scanned head with shapes: places of the skin, and the paths of our handles on it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from engine.formats.base.archive import arrays_of
from engine.formats.characters.ict import triangulated
from engine.lab.sculpting.clay import EYE_CENTRE
from engine.lab.sculpting.lips import HALF_WIDTH, SLIT_Y
from engine.take import Array, Mask

Indices = npt.NDArray[np.int64]
FACE, SKIN = 9409, 11248  # vertices of the face, and of face, head and neck, which come first
LEFT_EYE, LOWER_TEETH = slice(21451, 22221), slice(19247, 21451)
UPPER_LID, LOWER_LID = (3.44, 0.41), (3.53, -0.94)  # middle of the left lids' margins in our frame, (x, y) cm
LID_RADIUS = 1.55  # of the margin's path about the eyeball, cm
NEAR = 0.2  # cm; a handle's path is the mean of the vertices so near
LIPS_APART = 1.0  # cm that a vertex of the lower lip falls when the jaw opens


@dataclass(frozen=True, eq=False)
class MeasuredHead:
    """A head with shapes in our frame: cm, origin between the eyes, eyes as far apart as ours.

    Attributes
    ----------
    points : (n, 3)
    normals : (n, 3), unit
    deltas : (n, 3) by name of the shape there
    falls : (n,) bool, what the jaw takes along
    """

    points: Array
    normals: Array
    deltas: dict[str, Array]
    falls: Mask

    @classmethod
    def read(cls, path: Path) -> MeasuredHead:
        """Read a packed ICT-FaceKit."""
        stored = arrays_of(path, ("neutral", "faces", "shape_names", "deltas"))
        raw = stored["neutral"].astype(np.float64)
        eye = (raw[LEFT_EYE].min(axis=0) + raw[LEFT_EYE].max(axis=0)) / 2
        scale = EYE_CENTRE[0] / eye[0]
        points = (raw - [0.0, eye[1], eye[2]]) * scale + [0.0, EYE_CENTRE[1], EYE_CENTRE[2]]
        deltas = {
            str(name): delta.astype(np.float64) * scale
            for name, delta in zip(stored["shape_names"], stored["deltas"], strict=True)
        }
        normals = _normals(points, triangulated(stored["faces"]))
        return cls(points, normals, deltas, deltas["jawOpen"][:, 1] < -LIPS_APART)

    def delta(self, shape: str) -> Array | None:
        """Return the motion, (n, 3), of a shape of ours; the sum of both sides where it has two; None where it lacks it."""
        plain = shape.removesuffix("Left")
        for names in ((shape,), (f"{plain}_L",), (f"{shape}_L", f"{shape}_R")):
            if all(name in self.deltas for name in names):
                return np.asarray(sum(self.deltas[name] for name in names))
        return None

    def places(self, *, step: float, seed: int = 0) -> Array:
        """Return points of the left half's outer skin about `step` cm apart, (n, 3), denser in the face.

        Eyes, lips, nostrils and ears are left out: they have sculptures of their own.
        """
        candidates = self.points[:SKIN]
        x, y, _ = candidates.T
        keep = (x > -0.02) & (y > -19) & ~_featured(candidates) & ~((y < -12.5) & ((np.abs(x) > 6) | (y < -18)))
        candidates = candidates[keep]
        chosen: list[Array] = []
        for point in candidates[np.random.default_rng(seed).permutation(len(candidates))]:
            in_face = point[2] > 8 and -11.5 < point[1] < 2
            apart = step * (0.55 if in_face else 1.6 if point[2] < 3 else 1.0)
            if all(np.linalg.norm(point - other) > apart for other in chosen):
                chosen.append(point)
        return np.array(chosen)

    def matched(self, names: tuple[str, ...], places: Array) -> Indices:
        """Return the vertex that corresponds to each handle: places, (h, 3), of the left half by name."""
        return np.array([self._match(name, place) for name, place in zip(names, places, strict=True)])

    def _match(self, name: str, place: Array) -> int:
        points, falls, outer = self.points, self.falls, np.arange(len(self.points)) < FACE
        wider = 2.52 / HALF_WIDTH  # its mouth to ours
        if name in {"lip 8 24", "lip 4 24"}:
            return self._nearest(np.array([2.50, -7.28, 10.1]), outer)
        if name.startswith("lip 8"):
            upper = int(name.split()[2]) < 24
            column = np.abs(points[:, 0] - place[0] * wider) < 0.13
            slit = (np.abs(points[:, 1] - SLIT_Y) < 0.4) & (points[:, 2] > 9.8)
            found = np.flatnonzero(outer & column & slit & (falls != upper))
            return int(found[points[found, 1].argmin() if upper else points[found, 1].argmax()])
        facing = outer & (self.normals[:, 2] > (-0.2 if name.startswith("lip") else -0.3))
        if name.startswith("lip"):
            number = int(name.split()[2])
            if number != 24:
                facing &= (falls == (number > 24)) | (np.abs(points[:, 1] - SLIT_Y) > 1.6)
            place = place * [wider, 1, 1]
        return self._nearest(place, facing)

    def _nearest(self, place: Array, allowed: Mask) -> int:
        away = np.linalg.norm(self.points - place, axis=1)
        away[~allowed] = np.inf
        return int(away.argmin())

    def paths(self, shape: str, matched: Indices) -> Array | None:
        """Return the moves of all handles in a shape, (2 h, 3): left half and middle, then the mirrored places."""
        delta = self.delta(shape)
        if delta is None:
            return None
        mirrored = self.points[matched] * [-1, 1, 1]
        same = [self.falls[:FACE] == self.falls[vertex] for vertex in matched]
        right = [
            int(np.where(alike, np.linalg.norm(self.points[:FACE] - place, axis=1), np.inf).argmin())
            for place, alike in zip(mirrored, same, strict=True)
        ]
        tree = cKDTree(self.points[:FACE])
        return np.array([self._mean(delta, vertex, tree) for vertex in (*matched, *right)])

    def _mean(self, delta: Array, vertex: int, tree: cKDTree) -> Array:
        around = np.array(tree.query_ball_point(self.points[vertex], NEAR), np.int64)
        alike = (self.falls[around] == self.falls[vertex]) & (self.normals[around] @ self.normals[vertex] > 0.3)
        near = around[alike] if alike.any() else np.array([vertex])
        return np.asarray(delta[near].mean(axis=0))

    def lids(self, shape: str) -> tuple[float, float]:
        """Return the degrees that the left upper and lower lid rise on the eyeball in a shape."""
        delta = self.delta(shape)
        assert delta is not None
        rises = []
        for x, y in (UPPER_LID, LOWER_LID):
            vertex = self._nearest(np.array([x, y, 9.45]), np.arange(len(self.points)) < FACE)
            rises.append(round(float(np.degrees(delta[vertex, 1] / LID_RADIUS)), 1))
        return rises[0], rises[1]

    def jaw(self, shape: str, hinge: Array) -> tuple[float, Array]:
        """Return the turn of the lower teeth about x in degrees, and their shift at the hinge in cm, (3,)."""
        delta = self.delta(shape)
        assert delta is not None
        rest = self.points[LOWER_TEETH]
        moved = rest + delta[LOWER_TEETH]
        u, _, vt = np.linalg.svd((rest - rest.mean(axis=0)).T @ (moved - moved.mean(axis=0)))
        turn = (u @ vt).T
        shift = moved.mean(axis=0) - turn @ rest.mean(axis=0) + turn @ hinge - hinge
        return float(np.degrees(np.arctan2(turn[2, 1], turn[2, 2]))), shift


def _normals(points: Array, triangles: npt.NDArray[np.int32]) -> Array:
    corners = points[triangles]
    crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    summed = np.zeros_like(points)
    for corner in range(3):
        np.add.at(summed, triangles[:, corner], crossed)
    return np.asarray(summed / (np.linalg.norm(summed, axis=1, keepdims=True) + 1e-12))


def _featured(points: Array) -> Mask:
    """Return which points belong to eyes, lips, the inside of the mouth, nostrils and ears."""
    x, y, z = points.T
    eye = np.linalg.norm((points - [3.15, 0, 8.9]) / [2.0, 1.15, 2.2], axis=1) < 1
    lips = (np.abs(x) < 2.9) & (np.abs(y + 6.9) < 1.1) & (z > 6)
    inside = (z < 9.5) & (np.abs(x) < 3) & (y > -9) & (y < -3)
    nostril = (np.abs(x - 0.75) < 0.55) & (np.abs(y + 4.3) < 0.35) & (z < 12)
    ear = (np.abs(y + 1.3) < 4.6) & (x > 6.3) & (z < 1.9) & (z > -4.2)
    return np.asarray(eye | lips | inside | nostril | ear)
