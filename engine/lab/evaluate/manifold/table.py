"""Retargeting from labelled frames and driving a mesh by points, against RBF and Laplacian (ZLL17 section 4).

Source of the retargeting is the bundled head, target the second head with a random identity for each expression. Every
method is given the same points, labels and first guess; its settings were chosen on training takes and other identities.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from engine.character import Character, bundled
from engine.errors import EngineError
from engine.formats.characters import ict
from engine.formats.characters.assemble import assemble
from engine.jaw import drawable
from engine.lab.corpus import data_folder, pieces_to_measure, split, whole_faces
from engine.lab.evaluate.manifold.baselines import laplacian_influence, laplacian_retarget, rbf_influence, rbf_retarget
from engine.lab.reporting import Report, Row
from engine.manifold.drive import MeshDriver
from engine.manifold.placement import place_points
from engine.manifold.pose import fit_similarity
from engine.manifold.retarget import retarget_points, suggest_frames
from engine.mesh import parts_of
from engine.take import Array

LABELS = (2, 4, 6, 10, 20, 40)
EXPRESSIONS, FRAMES, FACES, POINTS = 50, 100, 50, 80
FACE_VERTICES = 9409  # of the second head: skin of the face, on which markers sit
SEED = 17
TRAINING_SAMPLES = 60  # expressions by which the points are placed
METHODS = ("semi_supervised", "rbf", "laplacian")


@dataclass(frozen=True, eq=False)
class Heads:
    """The second head with its identities, and the same points on it and on the bundled head.

    Attributes
    ----------
    target : the second head
    identities : (10, n, 3), mm
    points, source_points : (80,) vertices of the target and of the bundled head
    part : (t, 3) triangles of the part that carries the points; its vertices come first in the file
    part_size : number of its vertices
    """

    target: Character
    identities: Array
    points: npt.NDArray[np.int64]
    source_points: npt.NDArray[np.int64]
    part: npt.NDArray[np.int32]
    part_size: int

    def identity(self, rng: np.random.Generator) -> Array:
        """Return the neutral of a random person, (n, 3), mm."""
        return np.asarray(self.target.neutral + np.tensordot(rng.normal(size=len(self.identities)), self.identities, 1))


@lru_cache(maxsize=1)
def heads() -> Heads:
    """Read the second head and place the points by training expressions; raises `EngineError` without the data."""
    path = data_folder() / "ict_facekit" / "ict_facekit.npz"
    if not path.exists():
        raise EngineError("This table needs the second head.", "Set RETAKE_DATA to the folder that holds ict_facekit.")
    target = assemble(ict.read(path)).character
    with np.load(path, allow_pickle=False) as stored:
        identities = stored["identity_deltas"].astype(np.float64) * 10.0
    part_size = 1 + int(_first_part(target))
    part = target.triangles[(target.triangles < part_size).all(axis=1)]
    training, _, _ = split(data_folder())
    weights = np.concatenate([piece.weights for piece in whole_faces(training)])
    sample = drawable(weights[np.random.default_rng(SEED).choice(len(weights), TRAINING_SAMPLES, replace=False)])
    motions = np.tensordot(sample, target.deltas[:, :part_size].astype(np.float64), 1)
    allowed = np.arange(part_size) < FACE_VERTICES
    points = place_points(target.neutral[:part_size].astype(np.float64), part, motions, POINTS, allowed=allowed)
    return Heads(target, identities, points, _same_points(target, points), part, part_size)


def _first_part(target: Character) -> np.int64:
    parts = parts_of(target.triangles, len(target.neutral))
    return np.int64(np.flatnonzero(parts == parts[0]).max())


def _same_points(target: Character, points: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Return the bundled head's vertices nearest to the target's points, laid on by their common landmarks."""
    head = bundled()
    names = list(head.landmarks)
    start = target.neutral[[target.landmarks[name] for name in names]].astype(np.float64)
    end = head.neutral[[head.landmarks[name] for name in names]].astype(np.float64)
    laid = fit_similarity(start, end[None], mirrored=False).apply(target.neutral[points].astype(np.float64))[0]
    moving = np.flatnonzero(np.abs(head.deltas).max(axis=(0, 2)) > 0)
    return np.asarray(moving[cKDTree(head.neutral[moving]).query(laid)[1]])


def _performances(data: Path | None) -> list[Array]:
    found = [drawable(piece.weights) for piece in whole_faces(pieces_to_measure(data)) if len(piece.weights) >= FRAMES]
    if not found:
        raise EngineError(f"There is no whole-face take of {FRAMES} frames or more.", "Name a folder of longer takes.")
    return found


def expressions(data: Path | None) -> Iterator[tuple[Array, Array, Array]]:
    """Yield source points, target points, (100, 80, 3), and the target's points at rest, (80, 3), all in mm."""
    pair, rng = heads(), np.random.default_rng(SEED)
    performances = _performances(data)
    lengths = np.array([len(weights) for weights in performances], float)
    ours = bundled()
    for _ in range(EXPRESSIONS):
        weights = performances[rng.choice(len(performances), p=lengths / lengths.sum())]
        first = int(rng.integers(len(weights) - FRAMES + 1))
        clip = weights[first : first + FRAMES]
        rest = pair.identity(rng)[pair.points]
        source = ours.neutral[pair.source_points] + np.einsum("fs,spc->fpc", clip, ours.deltas[:, pair.source_points])
        yield source, rest + np.einsum("fs,spc->fpc", clip, pair.target.deltas[:, pair.points]), rest


def evenly(count: int, frames: int = FRAMES) -> npt.NDArray[np.int64]:
    """Return labelled frames spread evenly, first and last among them, as in the paper."""
    return np.asarray(np.linspace(0, frames - 1, count).round(), np.int64)


@lru_cache(maxsize=64)
def retarget_errors(data: Path | None, labels: int, method: str, *, suggested: bool = False) -> Array:
    """Return the distance of each frame's points from the truth, (expressions, frames), mm."""
    source_rest = bundled().neutral[heads().source_points].astype(np.float64)
    retarget = {"semi_supervised": retarget_points, "rbf": rbf_retarget, "laplacian": laplacian_retarget}[method]
    rows = []
    for source, target, rest in expressions(data):
        chosen = suggest_frames(source, labels) if suggested else evenly(labels)
        result = retarget(source, source_rest, rest, {int(frame): target[frame] for frame in chosen})
        rows.append(np.linalg.norm(result - target, axis=2).mean(axis=1))
    return np.array(rows)


def face_pairs(data: Path | None) -> Iterator[tuple[Array, Array]]:
    """Yield a person's neutral face and an expression of it, (n, 3), mm."""
    pair, rng = heads(), np.random.default_rng(SEED + 1)
    weights = np.concatenate(_performances(data))
    chosen = weights[np.sort(rng.choice(len(weights), FACES, replace=False))]
    for frame in chosen:
        rest = pair.identity(rng)
        yield rest, rest + np.tensordot(frame, pair.target.deltas.astype(np.float64), 1)


def drivers(rest: Array) -> dict[str, Callable[[Array], Array]]:
    """Return each method as a function from the points' positions to the labelled part's vertices."""
    pair = heads()
    part, points = rest[: pair.part_size], pair.points
    driver = MeshDriver(part, pair.part, points)

    def linear(influence: Array) -> Callable[[Array], Array]:
        return lambda positions: np.asarray(part + influence @ (positions - part[points]))

    return {
        "semi_supervised": lambda positions: driver.drive(positions[None])[0],
        "rbf": linear(rbf_influence(part, points)),
        "laplacian": linear(laplacian_influence(part, pair.part, points)),
    }


@lru_cache(maxsize=4)
def drive_errors(data: Path | None) -> dict[str, Array]:
    """Return by method the mean distance from the truth, (faces, 2), mm: over the face, over the whole labelled part.

    The whole part has the neck and the inside of the mouth too, where no marker sits and all methods guess.
    """
    pair = heads()
    found: dict[str, list[tuple[float, float]]] = {method: [] for method in METHODS}
    for rest, target in face_pairs(data):
        for method, driven in drivers(rest).items():
            away = np.linalg.norm(driven(target[pair.points]) - target[: pair.part_size], axis=1)
            found[method].append((float(away[:FACE_VERTICES].mean()), float(away.mean())))
    return {method: np.array(errors) for method, errors in found.items()}


def table(data: Path | None, report: Report) -> list[Row]:
    """Return the mean error in mm by task, method and number of labels (ZLL17 figures 6 and 10)."""
    rows: list[Row] = []
    for labels in LABELS:
        for method in METHODS:
            rows.append(_row("retarget", method, labels, retarget_errors(data, labels, method).mean(axis=1)))
        suggested = retarget_errors(data, labels, "semi_supervised", suggested=True).mean(axis=1)
        rows.append(_row("retarget", "semi_supervised_suggested", labels, suggested))
        report(f"retargeted with {labels} labels")
    for method, errors in drive_errors(data).items():
        rows.append(
            _row("drive", method, POINTS, errors[:, 0]) | {"error_with_mouth_inside": float(errors[:, 1].mean())}
        )
    return rows


def _row(task: str, method: str, labels: int, errors: Array) -> Row:
    return {
        "method": method,
        "task": task,
        "labels": labels,
        "error": float(errors.mean()),
        "worst": float(errors.max()),
        "unit": "mm",
    }
