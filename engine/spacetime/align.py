"""Alignment of two faces: head motion removed by Procrustes, proportions matched by an RBF (SLS12 section 3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import cdist, pdist, squareform

from engine.errors import EditError
from engine.take import Array, Mask
from engine.words import counted


@dataclass(frozen=True)
class Tuning:
    """Tolerances of the alignment; ranges tried were not recorded."""

    flat: float = 1e-6  # extent across, relative to along, below which points lie in a plane or on a line
    same: float = 1e-6  # distance, relative to the whole extent, below which two markers coincide
    rounds: int = 3  # of reweighting in `stillest`
    least_variance: float = 0.01  # share of the median variance added to each marker's


TUNING = Tuning()


@dataclass(frozen=True, eq=False)
class HeadMotion:
    """The pose of the head in each frame: ``seen = still @ rotation' + translation``.

    Attributes
    ----------
    rotations : (frames, 3, 3), proper rotations
    translations : (frames, 3) mm
    """

    rotations: Array
    translations: Array

    def remove(self, positions: Array) -> Array:
        """Return positions, (frames, n, 3) mm, as they would be with the head still."""
        return np.asarray((positions - self.translations[:, None]) @ self.rotations)

    def apply(self, positions: Array) -> Array:
        """Return positions, (frames, n, 3) mm, of a still head as they are on the moving one."""
        return np.asarray(positions @ self.rotations.transpose(0, 2, 1) + self.translations[:, None])

    def part(self, start: int, stop: int) -> HeadMotion:
        """Return the motion of frames [start, stop)."""
        return HeadMotion(self.rotations[start:stop], self.translations[start:stop])

    def seen_along(self, turn: Array, *, scale: float = 1.0, shift: Array | None = None) -> HeadMotion:
        """Return the same motion of a head in another coordinate system: ``placed = scale * still @ turn + shift``.

        Parameters
        ----------
        turn : (3, 3) rotation, acting on rows
        scale : of the placed head
        shift : (3,) mm; none where only rotations matter
        """
        rotations = turn.T @ self.rotations @ turn
        place = np.zeros(3) if shift is None else shift
        return HeadMotion(rotations, scale * self.translations @ turn + place - place @ rotations.transpose(0, 2, 1))

    def angles(self) -> Array:
        """Return head yaw, pitch and roll as Live Link Face has them, (frames, 3) radians.

        Turns of the head about its own up, right and front in this order: yaw is positive to the character's right, pitch
        downwards, roll towards the left shoulder. (The sign follows from its eye columns, which go with eyeLookIn and
        eyeLookOut; Unreal's ARKit plug-in treats head and eyes alike.)
        """
        r = self.rotations
        pitch = -np.arcsin(np.clip(r[:, 1, 2], -1, 1))
        return np.stack([-np.arctan2(r[:, 0, 2], r[:, 2, 2]), pitch, -np.arctan2(r[:, 1, 0], r[:, 1, 1])], axis=1)


def procrustes(positions: Array, neutral: Array, weights: Array | None = None) -> HeadMotion:
    """Return the rigid motion, without reflection, of the neutral face that best fits each frame (Kabsch).

    Parameters
    ----------
    positions : (frames, n, 3) mm; NaN where a marker is missing
    neutral : (n, 3) mm
    weights : (n,), of the markers, larger for bone than for skin; None for equal ones

    Raises
    ------
    EditError : naming the frame, where fewer than three markers that are not on one line are seen
    """
    seen: Mask = np.asarray(np.isfinite(positions).all(axis=2))
    share = seen * (np.ones(len(neutral)) if weights is None else weights)
    total = share.sum(axis=1, keepdims=True)
    known = np.where(seen[..., None], positions, 0.0)
    share = share / np.maximum(total, 1e-300)
    centre, rest_centre = np.einsum("fn,fnx->fx", share, known), share @ neutral
    moved = np.where(seen[..., None], positions - centre[:, None], 0.0)
    rest = neutral[None] - rest_centre[:, None]
    covariance = np.einsum("fn,fnx,fny->fxy", share, moved, rest)
    left, sizes, right = np.linalg.svd(covariance)
    _require_spread(sizes, seen)
    mirrored = np.linalg.det(left @ right) < 0
    left[mirrored, :, 2] *= -1
    rotations = left @ right
    return HeadMotion(rotations, centre - np.einsum("fxy,fy->fx", rotations, rest_centre))


def _require_spread(sizes: Array, seen: Mask) -> None:
    poor = (sizes[:, 1] <= TUNING.flat**2 * np.maximum(sizes[:, 0], 1e-300)) | (seen.sum(axis=1) < 3)
    if poor.any():
        frame = int(np.flatnonzero(poor)[0])
        raise EditError(
            f"In frame {frame} the markers do not tell how the head is turned: {int(seen[frame].sum())} are seen, "
            "and they lie on one line." if seen[frame].sum() >= 3 else
            f"In frame {frame} only {counted(int(seen[frame].sum()), 'marker')} can be seen; three are needed to find the head.",
            "Cut that part of the capture out, or fill its gaps.",
        )  # fmt: skip


def stillest(positions: Array, neutral: Array) -> HeadMotion:
    """Return the head motion by iteratively reweighted Procrustes, with weights of one over each marker's variance.

    Jaw and brows move with the performance and get small weights; a few rounds converge. Shapes and errors as `procrustes`.
    """
    weights = np.ones(len(neutral))
    motion = procrustes(positions, neutral)
    for _ in range(TUNING.rounds):
        away = ((motion.remove(positions) - neutral) ** 2).sum(axis=2)
        variance = np.nanmean(np.where(np.isfinite(away).any(axis=0), away, 0.0), axis=0)
        weights = 1 / (variance + TUNING.least_variance * float(np.median(variance)) + 1e-12)
        motion = procrustes(positions, neutral, weights / weights.max())
    return motion


class Warp:
    """Maps one set of points exactly onto another by radial basis functions: ``sum w |x - c| + A x + b``.

    Minimises the bending energy; exact everywhere where the two sets are related by an affine map (SLS12 section 3.2).

    Parameters
    ----------
    centres : (n, 3) mm, points of the space mapped from
    images : (n, 3) mm, where they go
    names : of the points, for errors
    """

    def __init__(self, centres: Array, images: Array, names: Sequence[str]) -> None:
        check_points(centres, names)
        count = len(centres)
        self._origin, self._size = centres.mean(axis=0), float(np.ptp(centres, axis=0).max())
        self._centres = (centres - self._origin) / self._size
        linear = np.hstack([self._centres, np.ones((count, 1))])
        matrix = np.zeros((count + 4, count + 4))
        matrix[:count, :count] = squareform(pdist(self._centres))
        matrix[:count, count:], matrix[count:, :count] = linear, linear.T
        self._solution = np.linalg.solve(matrix, np.vstack([images, np.zeros((4, 3))]))

    def __call__(self, points: Array) -> Array:
        """Return where points, (..., 3) mm, go."""
        flat = (points.reshape(-1, 3) - self._origin) / self._size
        kernel = cdist(flat, self._centres)
        mapped = kernel @ self._solution[:-4] + flat @ self._solution[-4:-1] + self._solution[-1]
        return np.asarray(mapped.reshape(points.shape))


def check_points(points: Array, names: Sequence[str]) -> None:
    """Raise `EditError`, with names, where points, (n, 3), are missing, too few, duplicate, on a line or in a plane."""
    found: Mask = np.asarray(np.isfinite(points).all(axis=1))
    missing = [name for name, known in zip(names, found, strict=True) if not known]
    if missing:
        raise EditError(f"{_listed(missing)} missing in the neutral frame.", "Choose a neutral frame that has them.")
    if len(points) < 4:
        raise EditError(
            f"Only {counted(len(points), 'marker')} in common ({', '.join(names)}); four are needed at least."
        )
    extents = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    gaps = squareform(pdist(points))
    np.fill_diagonal(gaps, np.inf)
    first, second = divmod(int(gaps.argmin()), len(points))
    if gaps[first, second] <= TUNING.same * max(float(extents[0]), 1e-300):
        raise EditError(
            f"The markers {names[first]} and {names[second]} are at the same place.", "Remove one of the two."
        )
    for dimension, shape in ((1, "on one line"), (2, "in one plane")):
        if extents[dimension] <= TUNING.flat * extents[0]:
            raise EditError(
                f"All markers ({_few(names)}) lie {shape}.",
                "Add markers at other depths, such as the nose or the ears.",
            )


def _few(names: Sequence[str]) -> str:
    return ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")


def _listed(names: Sequence[str]) -> str:
    return f"The marker {names[0]} is" if len(names) == 1 else f"The markers {_few(names)} are"
