"""Takes the prior from the recorded training faces: covariance, limits, a sample of faces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import torch

from engine.anatomy import MIRROR
from engine.character import Character, bundled
from engine.extended import bundled_face
from engine.lab.corpus import Piece, recorded_seconds, split, whole_faces
from engine.models.checkpoint import Card, commit, save_card, save_model
from engine.regress.prior import (
    ACROSS,
    KIND,
    LEFT_SHAPES,
    MIRROR_CONTROL,
    MIRROR_SIGN,
    MOUTH_ONLY,
    ONE_WAY_SHAPES,
    RIGHT_SHAPES,
    FacePrior,
    despiked,
)
from engine.take import SHAPES, Array

FACES = 4000  # whose controls are kept; a quarter of a megabyte
SEED = 0
MOVING_MM = 0.1  # a vertex that no shape moves further is no part of the skin that moves
LEAST_DEVIATION = 0.02  # of a weight; shapes that were hardly recorded may still move a little


def train(data: Path, out: Path, report: Callable[[str], None]) -> None:
    """Write the prior of the training split of a folder of takes, and its card."""
    pieces = split(data)[0]
    prior = learned(pieces, faces=FACES, seed=SEED)
    tensors = {
        "covariance": torch.from_numpy(prior.covariance),
        "surface": torch.from_numpy(prior.surface),
        "low": torch.from_numpy(prior.low),
        "high": torch.from_numpy(prior.high),
        "fastest": torch.from_numpy(prior.fastest),
        "faces": torch.from_numpy(prior.faces).float(),
        "whole": torch.from_numpy(prior.whole).to(torch.uint8),
    }
    path = out / "prior.safetensors"
    save_model(path, tensors, kind=KIND, config={})
    card = Card(
        kind=KIND,
        data={"recorded_seconds": recorded_seconds(pieces)},
        split="training takes without their last 15 %",
        seed=SEED,
        commit=commit(),
        settings={"faces": FACES},
        metrics={},
        notes="Covariance of weights with independent sides, limits of controls, controls of a sample of faces.",
    )
    save_card(path, card)
    report(f"wrote {path.name}")


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
    made = np.where(ACROSS, 0.0, made)
    made += np.diag(np.maximum(LEAST_DEVIATION**2, 0.05 * np.diag(made)))
    return np.asarray((made + made[np.ix_(MIRROR, MIRROR)]) / 2)


def _surface(character: Character) -> Array:
    """Return the mean over moving vertices of the products of shape deltas, (52, 52) in mm^2."""
    deltas = character.deltas.astype(np.float64)
    moving = np.abs(deltas).max(axis=(0, 2)) > MOVING_MM
    return np.where(ACROSS, 0.0, np.einsum("svx,tvx->st", deltas[:, moving], deltas[:, moving]) / moving.sum())
