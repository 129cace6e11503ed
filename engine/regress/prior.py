"""What recorded faces do: how their weights vary together, and how far and how fast each control was seen to go."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.ndimage import median_filter

from engine.character import Character, bundled
from engine.controls import ALL_CONTROLS
from engine.corpus import Piece, whole_faces
from engine.extended import bundled_face
from engine.models.checkpoint import MODELS, load_model
from engine.performance.augment import MIRROR
from engine.take import SHAPES, Array

KIND = "prior"
Columns = npt.NDArray[np.int64]
# Of each control, its mirror image and the sign it takes there.
MIRROR_CONTROL: Columns = np.array(
    [
        next(
            index
            for index, other in enumerate(ALL_CONTROLS)
            if other.name == control.name.replace("left", "#").replace("right", "left").replace("#", "right")
        )
        for control in ALL_CONTROLS
    ]
)
MIRROR_SIGN: Array = np.array(
    [-1.0 if control.name in ("jaw_sideways", "gaze_horizontal") else 1.0 for control in ALL_CONTROLS]
)
_ONE_WAY = ("jawRight", "jawLeft", "mouthRight", "mouthLeft")  # directions of the whole mouth, not sides of the face
RIGHT_SHAPES, LEFT_SHAPES = (
    np.array([name.endswith(side) and name not in _ONE_WAY for name in SHAPES]) for side in ("Right", "Left")
)
_ACROSS = RIGHT_SHAPES[:, None] & LEFT_SHAPES | LEFT_SHAPES[:, None] & RIGHT_SHAPES
ONE_WAY_SHAPES = np.array([name in _ONE_WAY for name in SHAPES])
MOUTH_ONLY = np.array([control.area == "lower" for control in ALL_CONTROLS])
SPIKE_S = 0.17  # a departure shorter than half of this is no motion; the median of five frames at the model rate
MOVING_MM = 0.1  # a vertex that no shape moves further is no part of the skin that moves
LEAST_DEVIATION = 0.02  # of a weight; shapes that were hardly recorded may still move a little


@dataclass(frozen=True, eq=False)
class FacePrior:
    """Statistics of the recorded training faces and their mirror images.

    Attributes
    ----------
    covariance : (52, 52) of weights, the two sides of the face made independent of each other
    surface : (52, 52) by which weights' squares are mm^2 that the skin moves, likewise
    low, high : (16,) the least and the most that each control was recorded at
    fastest : (16,) the most that a control departed from its median over `SPIKE_S`
    faces : (faces, 16) controls of recorded faces, from which joint limits are taken
    whole : (faces,) bool, which of them animate more than the mouth
    """

    covariance: Array
    surface: Array
    low: Array
    high: Array
    fastest: Array
    faces: Array
    whole: npt.NDArray[np.bool_]
    _balls: dict[tuple[tuple[int, ...], float], tuple[Array, Array, float]] = field(default_factory=dict)

    def metric(self, stiffness: float) -> Array:
        """Return the covariance, (52, 52), of weights when moving the skin costs too: ``(S^-1 + stiffness G)^-1``."""
        made = np.linalg.inv(np.linalg.inv(self.covariance) + stiffness * self.surface)
        made = np.where(_ACROSS, 0.0, made)
        return np.asarray((made + made[np.ix_(MIRROR, MIRROR)]) / 2)

    def ball(self, columns: Columns, share: float) -> tuple[Array, Array, float]:
        """Return mean, (n,), whitening matrix, (n, n), and radius within which a share of recorded faces lies.

        They are of the controls `columns` alone: what no one asked of the others does not count.
        """
        key = tuple(columns.tolist()), share
        if key not in self._balls:
            chosen = self.faces[:, columns] if MOUTH_ONLY[columns].all() else self.faces[self.whole][:, columns]
            mean = chosen.mean(axis=0)
            covariance = np.atleast_2d(np.cov(chosen.T))
            covariance = covariance + 0.01 * np.diag(np.diag(covariance))  # two lids are all but one control
            whiten = np.linalg.inv(np.linalg.cholesky(covariance))
            norms = np.linalg.norm((chosen - mean) @ whiten.T, axis=1)
            self._balls[key] = mean, whiten, float(np.quantile(norms, share))
        return self._balls[key]


def learned(pieces: Sequence[Piece], *, faces: int, seed: int) -> FacePrior:
    """Return the prior of recorded pieces, which keeps the controls of at most so many of their faces."""
    whole, every = whole_faces(pieces), list(pieces)
    curves = [bundled_face().measure(piece.weights) for piece in every]
    of_all = np.concatenate(curves)
    is_whole = np.concatenate([np.full(len(piece.weights), piece.whole_face) for piece in every])
    of_whole = of_all[is_whole]
    seen = [np.where(MOUTH_ONLY, all_, part) for all_, part in ((f(of_all), f(of_whole)) for f in (_least, _most))]
    rapid = [
        np.abs(curve - despiked(curve, fps=30.0)).max(axis=0)
        for curve, piece in zip(curves, every, strict=True)
        if piece.whole_face
    ]
    chosen = np.sort(np.random.default_rng(seed).permutation(len(of_all))[: faces // 2])
    kept = np.concatenate([of_all[chosen], _mirrored(of_all[chosen])])
    low, high, fastest = seen[0], seen[1], np.max(rapid, axis=0)
    return FacePrior(
        _independent_sides(_covariance(every, whole)),
        _surface(bundled()),
        np.minimum(low, np.minimum(*_pair(low, high))),
        np.maximum(high, np.maximum(*_pair(low, high))),
        np.maximum(fastest, fastest[MIRROR_CONTROL]),
        kept,
        np.concatenate([is_whole[chosen]] * 2),
    )


def despiked(curves: Array, *, fps: float) -> Array:
    """Return the running median of curves, (frames, n), over `SPIKE_S`."""
    width = 2 * round(SPIKE_S * fps / 2 - 0.5) + 1
    return np.asarray(median_filter(curves, size=(max(3, width), 1), mode="nearest"))


def _least(curves: Array) -> Array:
    return np.asarray(curves.min(axis=0))


def _most(curves: Array) -> Array:
    return np.asarray(curves.max(axis=0))


def _pair(low: Array, high: Array) -> tuple[Array, Array]:
    """Return both limits as they are in a mirror."""
    return MIRROR_SIGN * low[MIRROR_CONTROL], MIRROR_SIGN * high[MIRROR_CONTROL]


def _mirrored(curves: Array) -> Array:
    return np.asarray(MIRROR_SIGN * curves[:, MIRROR_CONTROL])


def _covariance(every: Sequence[Piece], whole: Sequence[Piece]) -> Array:
    """Return the mean, (52, 52), of the covariance over all pieces and that over whole faces."""

    def of(pieces: Sequence[Piece]) -> Array:
        weights = np.concatenate([piece.weights for piece in pieces])
        return np.asarray(np.cov(np.concatenate([weights, weights[:, MIRROR]]).T))

    return np.asarray((of(every) + of(whole)) / 2)


def _independent_sides(covariance: Array) -> Array:
    """Return a covariance, (52, 52), in which what one side does tells nothing of the other.

    In sums and differences of mirrored shapes a symmetric covariance falls into two blocks. Recorded faces hardly ever
    differ from side to side, so that a corner pulled alone would take the other along; where differences vary as sums
    do, left and right are independent, and a smile of one side is half of a smile.
    """
    even = (np.eye(len(SHAPES)) + np.eye(len(SHAPES))[MIRROR]) / 2
    odd = np.eye(len(SHAPES)) - even
    sided = RIGHT_SHAPES | LEFT_SHAPES
    signed = np.where(sided[:, None] & sided, covariance, 0.0)
    sign = np.where(LEFT_SHAPES, 1.0, np.where(RIGHT_SHAPES, -1.0, 0.0))
    alike = even @ signed @ even
    differing = sign[:, None] * alike * sign  # differences vary as sums do
    one_way = np.where(ONE_WAY_SHAPES[:, None] & ONE_WAY_SHAPES, covariance, 0.0)
    made = even @ covariance @ even + differing + odd @ one_way @ odd
    made = np.where(_ACROSS, 0.0, made)
    made += np.diag(np.maximum(LEAST_DEVIATION**2, 0.05 * np.diag(made)))
    return np.asarray((made + made[np.ix_(MIRROR, MIRROR)]) / 2)


def _surface(character: Character) -> Array:
    """Return the mean over moving vertices of the products of shape deltas, (52, 52) in mm^2."""
    deltas = character.deltas.astype(np.float64)
    moving = np.abs(deltas).max(axis=(0, 2)) > MOVING_MM
    return np.where(_ACROSS, 0.0, np.einsum("svx,tvx->st", deltas[:, moving], deltas[:, moving]) / moving.sum())


def load(folder: Path = MODELS) -> FacePrior:
    """Read the prior; raises `AssetError` where it is missing or damaged."""
    tensors, _ = load_model(folder / "prior.safetensors", kind=KIND)
    stored: dict[str, Array] = {name: np.asarray(tensor, np.float64) for name, tensor in tensors.items()}
    return FacePrior(
        covariance=stored["covariance"],
        surface=stored["surface"],
        low=stored["low"],
        high=stored["high"],
        fastest=stored["fastest"],
        faces=stored["faces"],
        whole=stored["whole"] > 0,
    )


@lru_cache(maxsize=1)
def bundled_prior() -> FacePrior:
    """Return the prior that ships with the program."""
    return load()
