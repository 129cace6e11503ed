"""Retargets a performance to another head from a few labelled frames (ZLL17 section 3.2)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from engine.errors import EditError
from engine.manifold.patches import Indices, LabelSolver, Progress, alignment, ignore, similar
from engine.pose import Pose, filled
from engine.take import SHAPES, Array, Take
from engine.words import counted

COORDINATES = 40  # principal coordinates that distinguish frames; the rest is noise, and slow to search
GAIN_RIDGE = 0.3  # ridge of a gain, in labels of typical size; chosen on the validation takes


@dataclass(frozen=True)
class Settings:
    """The settings of the manifold; chosen on the training takes (`retake evaluate manifold`).

    neighbours : frames in a patch
    dimension : of a patch's tangent space, the directions in which source and target may move differently
    stiffness : cost of motion that differs from the base's
    beta : weight of a labelled frame
    at_once : frames solved together; of a longer take these are spread over it, and each other frame follows its patch
    """

    neighbours: int = 100
    dimension: int = 20
    stiffness: float = 1e-4
    beta: float = 1e3
    at_once: int = 1200


class Retargeter:
    """Solves for target frames with the source's local structure, given a few of them; factorised once for its labels.

    With R the target less a first guess (`base`), minimises ``trace(R^T B R) + beta * |R[labelled] - labels|^2``, B from
    patches of like source frames (ZLL17 eq. 15): between labels the target moves as the source does.

    Parameters
    ----------
    source : (frames, D) features of the source, such as feature points in mm
    base : (frames, q) the target as it would be with no labels
    labelled : (m,) frames
    progress : called with the share that is done, 0..1; it may raise, to stop

    Raises
    ------
    EditError : no label, a frame outside the source or labelled twice, values that are not finite
    """

    def __init__(
        self,
        source: Array,
        base: Array,
        labelled: Indices,
        settings: Settings = Settings(),
        progress: Progress = ignore,
    ) -> None:
        self._base = np.asarray(base, np.float64)
        self._labelled = np.asarray(labelled, np.int64)
        _require_usable(source, self._base, self._labelled)
        points = coordinates(source)
        self._solved = _spread(len(points), self._labelled, settings.at_once)
        energy = alignment(
            points[self._solved],
            similar(points[self._solved], size=settings.neighbours),
            dimension=settings.dimension,
            stiffness=settings.stiffness,
            progress=progress,
        )
        place = np.searchsorted(self._solved, self._labelled)
        self._solver = LabelSolver(energy, place, beta=settings.beta)
        self._points, self._settings = points, settings

    def solve(self, labels: Array) -> Array:
        """Return the target, (frames, q), for the labelled frames' values, (m, q)."""
        labels = np.asarray(labels, np.float64)
        if labels.shape != (len(self._labelled), self._base.shape[1]):
            raise EditError(
                f"{counted(len(labels), 'label')} given for {counted(len(self._labelled), 'labelled frame')}."
            )
        if not np.isfinite(labels).all():
            raise EditError("A label holds a value that is not a finite number.")
        known = self._solver.solve(labels - self._base[self._labelled])
        result = self._base.copy()
        result[self._solved] += known
        others = np.setdiff1d(np.arange(len(result)), self._solved)
        if len(others):
            result[others] += _by_patch(self._points, others, self._solved, known, self._settings)
        return result

    def uncertainty(self) -> Array:
        """Return each frame's standard deviation given the labels, (frames,), up to a factor; of the nearest solved frame."""
        known = self._solver.uncertainty()
        nearest = cKDTree(self._points[self._solved]).query(self._points)[1]
        return np.asarray(known[nearest], np.float64)


def coordinates(source: Array) -> Array:
    """Return frames as principal coordinates, (frames, <= 40): distances between frames stay as they are."""
    flat = np.asarray(source, np.float64).reshape(len(source), -1)
    centred = flat - flat.mean(axis=0)
    _, axes = np.linalg.eigh(centred.T @ centred)
    return np.asarray(centred @ axes[:, ::-1][:, :COORDINATES])


def suggest_frames(source: Array, count: int, *, labelled: Sequence[int] = (), at_once: int = 1200) -> list[int]:
    """Return which frames to label next, best first: each brings the take's other frames nearest to a labelled one.

    Greedy k-median on the distance between frames. (Always labelling the frame least like the others measured worse
    than evenly spaced labels: such frames are alone in what they do.)

    Parameters
    ----------
    source : (frames, D) features of the source
    count : how many to add
    labelled : frames that have a label already
    at_once : frames that are compared; of a longer take these are spread over it
    """
    points = coordinates(source)
    candidates = _spread(len(points), np.asarray(labelled, np.int64), at_once)
    away = cdist(points[candidates], points[candidates])
    nearest = np.full(len(candidates), away.max() + 1.0)
    for frame in labelled:
        nearest = np.minimum(nearest, away[np.searchsorted(candidates, frame)])
    suggested: list[int] = []
    for _ in range(min(count, len(candidates) - len(set(labelled)))):
        best = int(np.argmin(np.minimum(away, nearest).sum(axis=1)))
        suggested.append(int(candidates[best]))
        nearest = np.minimum(nearest, away[best])
    return suggested


def scaled_to(base: Array, rest: Array, labelled: Indices, labels: Array) -> Array:
    """Return the base, (frames, n, d), each point with its own linear gain that brings it nearer to its labels.

    The gain is a ridge regression through rest, of the labels' difference from the base on the base's difference from rest. A
    few labels then decide frames unlike any of them, where the manifold alone would go back to the base.

    Parameters
    ----------
    rest : (n, d) the base at rest
    labelled, labels : (m,) frames and their labels, (m, n, d)
    """
    away = base - rest
    known, missing = away[labelled], labels - base[labelled]
    doubt = GAIN_RIDGE * np.maximum((away**2).sum(axis=2).mean(axis=0), 1e-12)
    gram = np.einsum("fnd,fne->nde", known, known) + doubt[:, None, None] * np.eye(base.shape[2])
    gain = np.linalg.solve(gram, np.einsum("fnd,fne->nde", known, missing))
    return np.asarray(base + np.einsum("fnd,nde->fne", away, gain))


def retarget_points(
    source: Array, source_rest: Array, target_rest: Array, labels: dict[int, Array], settings: Settings | None = None
) -> Array:
    """Return feature points of the target, (frames, n, 3), from those of the source and a few labelled frames.

    Parameters
    ----------
    source : (frames, n, 3)
    source_rest, target_rest : (n, 3) the same points on both heads at rest
    labels : the target's points, (n, 3), by frame
    """
    size = np.linalg.norm(target_rest - target_rest.mean(axis=0)) / np.linalg.norm(
        source_rest - source_rest.mean(axis=0)
    )
    base = target_rest + size * (source - source_rest)
    frames = np.array(sorted(labels), np.int64)
    targets = np.array([labels[int(frame)] for frame in frames]).reshape(-1, *target_rest.shape)
    moved = (source - source_rest).reshape(len(source), -1)
    target, _ = _between_rest_and_labels(moved, base, target_rest, frames=frames, labels=targets, settings=settings)
    return target


@dataclass(frozen=True, eq=False)
class Labelled:
    """A take from labels, and the uncertainty of each frame, (frames,): the largest is the next to label."""

    take: Take
    uncertainty: Array


def from_labels(
    take: Take,
    labels: Mapping[int, Pose],
    settings: Settings | None = None,
    *,
    source: Array | None = None,
    progress: Progress = ignore,
) -> Labelled:
    """Retarget a take to a target with shapes, given the target's weights at a few frames.

    Parameters
    ----------
    take : the target's weights as they would be with no labels
    labels : by frame; a shape that is not named, or NaN, stays as the take has it there
    source : (frames, D) features that distinguish frames, zero where the source is at rest; the take's weights without it
    progress : called with the share that is done, 0..1; it may raise, to stop
    """
    frames = np.array(sorted(labels), np.int64)
    _require_within(frames, len(take))
    poses = np.array([filled(labels[int(frame)]) for frame in frames])
    targets = np.where(np.isnan(poses), take.weights[frames], poses)[..., None]
    points, rest = take.weights if source is None else source, np.zeros((len(SHAPES), 1))
    target, uncertainty = _between_rest_and_labels(
        points, take.weights[..., None], rest, frames=frames, labels=targets, settings=settings, progress=progress
    )
    low, high = np.minimum(take.weights.min(axis=0), 0.0), np.maximum(take.weights.max(axis=0), 1.0)
    return Labelled(take.with_weights(np.clip(target[..., 0], low, high)), uncertainty)


def retarget_weights(
    take: Take, labels: Mapping[int, Pose], settings: Settings | None = None, *, source: Array | None = None
) -> Take:
    """Return the take of `from_labels` alone."""
    return from_labels(take, labels, settings, source=source).take


def _between_rest_and_labels(
    source: Array,
    base: Array,
    rest: Array,
    *,
    frames: Indices,
    labels: Array,
    settings: Settings | None,
    progress: Progress = ignore,
) -> tuple[Array, Array]:
    """Return the target, (frames, n, d), and each frame's uncertainty, of a source that is zero at rest.

    Rest is one more data point, and one more label: where the source is at rest, so is the target.
    """
    _require_within(frames, len(base))
    guess = np.concatenate([scaled_to(base, rest, frames, labels), rest[None]]).reshape(len(base) + 1, -1)
    points = np.vstack([source.reshape(len(source), -1), np.zeros((1, source[0].size))])
    retargeter = Retargeter(points, guess, np.append(frames, len(base)), settings or Settings(), progress)
    target = retargeter.solve(np.vstack([labels.reshape(len(frames), -1), rest.reshape(1, -1)]))
    return target[:-1].reshape(base.shape), retargeter.uncertainty()[:-1]


def _require_within(labelled: Indices, frames: int) -> None:
    if not len(labelled):
        raise EditError("There is no labelled frame.", "Pose the target at one frame or more.")
    outside = labelled[(labelled < 0) | (labelled >= frames)]
    if len(outside):
        raise EditError(f"Frame {outside[0]} has a label; the source has {counted(frames, 'frame')}.")


def _require_usable(source: Array, base: Array, labelled: Indices) -> None:
    _require_within(labelled, len(source))
    if (np.diff(np.sort(labelled)) == 0).any():
        raise EditError("A frame is labelled twice.")
    if len(base) != len(source) or not (np.isfinite(source).all() and np.isfinite(base).all()):
        raise EditError("The source holds values that are not finite numbers.", "Fill its gaps first.")


def _spread(frames: int, labelled: Indices, at_once: int) -> Indices:
    """Return the frames that are solved together, labelled ones among them, sorted."""
    if frames <= at_once:
        return np.arange(frames)
    return np.union1d(np.linspace(0, frames - 1, at_once).round().astype(np.int64), labelled)


def _by_patch(points: Array, others: Indices, solved: Indices, known: Array, settings: Settings) -> Array:
    """Return the frames that were not solved, by the affine map of the patch of solved frames round each."""
    size = min(settings.neighbours, len(solved))
    tree = cKDTree(points[solved])
    result = np.zeros((len(others), known.shape[1]))
    for row, frame in enumerate(others):
        away, near = tree.query(points[frame], k=size)
        away, near = np.atleast_1d(away), np.atleast_1d(near)
        weights = (away[0] + 1e-9) / (away + 1e-9)
        weights = weights**2 / (weights**2).sum()
        mean = weights @ points[solved[near]]
        root = np.sqrt(weights)[:, None]
        left, extent, right = np.linalg.svd(root * (points[solved[near]] - mean), full_matrices=False)
        gain = extent / (extent**2 + max(settings.stiffness * extent[0] ** 2, 1e-300))
        gain[settings.dimension :] = 0.0
        average = weights @ known[near]
        slope = (left * gain).T @ (root * (known[near] - average))
        result[row] = average + ((points[frame] - mean) @ right.T) @ slope
    return result
