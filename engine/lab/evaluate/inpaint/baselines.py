"""What a fill is measured against: curves that artists' programs offer, propagation, and copying from recordings."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.interpolate import CubicHermiteSpline, make_smoothing_spline
from scipy.linalg import solveh_banded

from engine.inpaint.gap import Gap
from engine.inpaint.seams import constrain
from engine.lab.corpus import Piece
from engine.take import SHAPES, Array

Method = Callable[[Gap], Array]
SMOOTHING = 0.1  # lambda of the smoothing spline; of 1e-3 ... 100 the best MAE up to 0.5 s on validation takes
PRIOR = 1e-5  # weight of the PCA prior in propagation; of 1e-5 ... 1e-2 likewise
_AROUND = 8  # known frames on either side by which a recorded segment is chosen


def _each(gap: Gap, make: Callable[[Array, Array, Array], Array]) -> Array:
    """Fill shapes that are unknown at the same frames together: `make(known frames, their values, unknown frames)`."""
    filled, frames = gap.known.copy(), np.arange(len(gap.known), dtype=np.float64)
    free = np.isnan(gap.known)
    for pattern in np.unique(free, axis=1).T:
        columns = np.flatnonzero((free == pattern[:, None]).all(axis=0))
        if pattern.any():
            known = gap.known[np.ix_(~pattern, columns)]
            filled[np.ix_(pattern, columns)] = 0.0 if pattern.all() else make(frames[~pattern], known, frames[pattern])
    return np.where(free, np.clip(filled, 0.0, 1.0), gap.known)


def linear(gap: Gap) -> Array:
    """Return straight lines between known values."""
    return _each(gap, _straight)


def _straight(at: Array, values: Array, free: Array) -> Array:
    return np.stack([np.interp(free, at, curve) for curve in values.T], axis=1)


def hermite(gap: Gap) -> Array:
    """Return cubic Hermite curves; slopes are one-sided at seams and central (Catmull-Rom) at pins."""

    def make(at: Array, values: Array, free: Array) -> Array:
        if len(at) < 2:
            return np.repeat(values, len(free), axis=0)
        slopes = np.gradient(values, at, axis=0)
        wide = np.diff(at) > 1
        for seam in np.flatnonzero(wide):  # beside a hole, the slope of the known side where there is one
            if seam > 0 and not wide[seam - 1]:
                slopes[seam] = values[seam] - values[seam - 1]
            if seam + 2 < len(at) and not wide[seam + 1]:
                slopes[seam + 1] = values[seam + 2] - values[seam + 1]
        return np.asarray(CubicHermiteSpline(at, values, slopes)(np.clip(free, at[0], at[-1])))

    return _each(gap, make)


def spline(gap: Gap) -> Array:
    """Return smoothing splines through the known frames nearby, moved onto the seams and pins."""

    def make(at: Array, values: Array, free: Array) -> Array:
        near = (at >= free[0] - 30) & (at <= free[-1] + 30)
        at, values = at[near], values[near]
        if len(at) < 5:
            return _straight(at, values, free)
        curve = make_smoothing_spline(at, values, lam=SMOOTHING)
        return np.asarray(curve(np.clip(free, at[0], at[-1])) + _straight(at, values - curve(at), free))

    return _each(gap, make)


class Propagation:
    """SLS12: velocities as the guide's, or none, with a PCA prior, between seams and pins.

    Minimises ``|D1 (x - g)|^2 + alpha (x - mean)^T C^-1 (x - mean)`` over the unknown frames, g the guide or constant.
    Every principal component is one tridiagonal system.

    Parameters
    ----------
    faces : (n, 52) training faces, from which mean and covariance come
    prior : alpha
    """

    def __init__(self, faces: Array, prior: float = PRIOR) -> None:
        self._mean, self._covariance, self._prior = faces.mean(axis=0), np.cov(faces, rowvar=False), prior

    def __call__(self, gap: Gap) -> Array:
        """Return the filled weights; all unknown shapes must be unknown at the same frames."""
        free = np.isnan(gap.known)
        shapes, unknown = free.any(axis=0), np.flatnonzero(free.any(axis=1))
        mean = self._mean[shapes]
        variance, modes = np.linalg.eigh(self._covariance[np.ix_(shapes, shapes)])
        coordinates = np.nan_to_num((gap.known[:, shapes] - mean) @ modes)
        steps = np.nan_to_num(np.diff(gap.guide[:, shapes], axis=0)) @ modes
        pull = np.zeros_like(coordinates)
        pull[1:] += steps + coordinates[:-1]
        pull[:-1] += coordinates[1:] - steps
        sides = (unknown > 0).astype(float) + (unknown < len(free) - 1)
        bands = np.zeros((2, len(unknown)))
        bands[1, :-1] = -(np.diff(unknown) == 1).astype(float)
        modal = coordinates.copy()
        for mode, spread in enumerate(np.maximum(variance, 1e-5)):
            bands[0] = sides + self._prior / spread
            modal[unknown, mode] = solveh_banded(bands, pull[unknown, mode], lower=True)
        filled = gap.known.copy()
        filled[:, shapes] = modal @ modes.T + mean
        return np.where(free, np.clip(filled, 0.0, 1.0), gap.known)


class Nearest:
    """The recorded segment whose surroundings, pins and guide are nearest, moved onto the seams.

    Parameters
    ----------
    pieces : training pieces to copy from
    spread : (52,), optional; distances are in units of its root
    """

    def __init__(self, pieces: Sequence[Piece], spread: Array | None = None) -> None:
        self._unit = np.ones(len(SHAPES)) if spread is None else np.sqrt(spread)
        self._pieces = [np.asarray(piece.weights) for piece in pieces if piece.whole_face]
        self._mouths = [np.asarray(piece.weights) for piece in pieces]

    @classmethod
    def own(cls, rest: Sequence[Array], spread: Array) -> Nearest:
        """Copy from the rest of the very take that has the hole."""
        return cls([Piece(weights, True, "") for weights in rest], spread)

    def __call__(self, gap: Gap) -> Array:
        """Return the filled weights; straight lines where no recording is as long as the hole."""
        free = np.isnan(gap.known)
        shapes, rows = free.any(axis=0), np.flatnonzero(free.any(axis=1))
        first, last = max(0, rows[0] - _AROUND), min(len(free), rows[-1] + 1 + _AROUND)
        wanted = np.where(np.isnan(gap.known), gap.guide, gap.known)[first:last, shapes]
        pieces = self._pieces if shapes.all() else self._mouths
        best, segment = np.inf, None
        for piece in pieces:
            costs = _costs(piece[:, shapes] / self._unit[shapes], wanted / self._unit[shapes])
            if len(costs) and costs.min() < best:
                best, start = float(costs.min()), int(costs.argmin())
                segment = piece[start : start + last - first]
        if segment is None:
            return linear(gap)
        motion = gap.known.copy()
        motion[first:last] = segment
        motion = constrain(motion, gap.known)
        return np.where(free, np.clip(motion, 0.0, 1.0), gap.known)


def _costs(piece: Array, wanted: Array) -> Array:
    """Return the squared distance of every segment of a piece to the known part of what is wanted, (segments,)."""
    segments = len(piece) - len(wanted) + 1
    costs = np.zeros(max(0, segments))
    for row, face in enumerate(wanted):
        there = np.isfinite(face)
        if segments > 0 and there.any():
            off = piece[row : row + segments, there] - face[there]
            costs += np.einsum("ts,ts->t", off, off)
    return costs
