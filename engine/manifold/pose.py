"""The common motion of points: rotation, mirroring, size and place, told from what the points do on their own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engine.take import Array

ROUNDS = 8
SHARE = 0.25  # of the points' typical distance from the fit, below which a distance counts no less


@dataclass(frozen=True, eq=False)
class Poses:
    """Similarity motions ``y = scale * x @ turn + shift``, one for each frame.

    Attributes
    ----------
    turn : (frames, 3, 3) orthogonal, acting on rows; a reflection where the points are mirrored
    scale : (frames,)
    shift : (frames, 3), in the unit of the points
    """

    turn: Array
    scale: Array
    shift: Array

    def apply(self, points: Array) -> Array:
        """Return moved points, (frames, n, 3), for points (n, 3) or (frames, n, 3)."""
        return np.asarray(self.scale[:, None, None] * (points @ self.turn) + self.shift[:, None])

    def undo(self, points: Array) -> Array:
        """Return points, (frames, n, 3), as they were before the motion."""
        back = (points - self.shift[:, None]) @ self.turn.transpose(0, 2, 1)
        return np.asarray(back / self.scale[:, None, None])


def fit_similarity(rest: Array, moved: Array, *, scaled: bool = True, mirrored: bool = True) -> Poses:
    """Return the motion that most of the points share, fitted whatever the others do.

    Procrustes with Cauchy weights, reweighted in rounds: a jaw that opens does not turn the head, and what does not take
    part in an expression tells the motion almost alone. Exact where all points move alike.

    Parameters
    ----------
    rest : (n, 3), or (frames, n, 3) where each frame has its own
    moved : (frames, n, 3)
    """
    rest = np.broadcast_to(rest, moved.shape)
    weights = np.ones(moved.shape[:2])
    for _ in range(ROUNDS):
        poses = _weighted(rest, moved, weights, scaled=scaled, mirrored=mirrored)
        away = np.linalg.norm(poses.apply(rest) - moved, axis=2)
        typical = np.maximum(SHARE * np.median(away, axis=1, keepdims=True), 1e-12)
        weights = 1.0 / (1.0 + (away / typical) ** 2)
    return poses


def _weighted(rest: Array, moved: Array, weights: Array, *, scaled: bool, mirrored: bool) -> Poses:
    """Closed-form weighted Procrustes (Umeyama), frames at once."""
    share = weights / weights.sum(axis=1, keepdims=True)
    centre_rest = np.einsum("fn,fnd->fd", share, rest)
    centre_moved = np.einsum("fn,fnd->fd", share, moved)
    x, y = rest - centre_rest[:, None], moved - centre_moved[:, None]
    left, spread, right = np.linalg.svd((share[:, :, None] * x).transpose(0, 2, 1) @ y)
    sign = np.ones_like(spread)
    flips = np.linalg.det(left @ right) < 0
    certain = spread[:, 2] > 1e-3 * spread[:, 0]  # for flat points a mirror image is also a rotation
    sign[:, 2] = np.where(flips & ~(certain & mirrored), -1.0, 1.0)
    turn = (left * sign[:, None, :]) @ right
    size = np.einsum("fn,fnd->f", share, x**2)
    scale = (spread * sign).sum(axis=1) / np.maximum(size, 1e-300) if scaled else np.ones(len(rest))
    scale = np.where(scale > 0, scale, 1.0)
    shift = centre_moved - scale[:, None] * np.einsum("fd,fde->fe", centre_rest, turn)
    return Poses(turn, scale, shift)
