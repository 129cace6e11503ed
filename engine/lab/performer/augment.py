"""More people from few: the levers that make up for nineteen minutes of recordings, each of which can be switched off."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from engine.anatomy import MIRROR, mirrored
from engine.models.resample import interpolate
from engine.take import SHAPES, Array


@dataclass(frozen=True)
class Levers:
    """Which augmentations are on, and how strong.

    Attributes
    ----------
    copies : variants made of each piece beside the original
    mirror : exchange left and right, in names and in signs
    gain : standard deviation of the logarithm of a random gain per shape; left and right share most of theirs
    warp : largest relative change of tempo
    mix : share of copies that are a mixture of two pieces
    recombine : share of copies that take the upper face from another piece
    stretch : frames that share one draw of all this, so that a long take makes many people; 0 for a piece at a time
    """

    copies: int = 6
    mirror: bool = True
    gain: float = 0.3
    warp: float = 0.2
    mix: float = 0.3
    recombine: float = 0.3
    stretch: int = 0


LOWER: npt.NDArray[np.bool_] = np.array([name.startswith(("jaw", "mouth", "cheekPuff", "tongue")) for name in SHAPES])


def augment(pieces: Sequence[Array], levers: Levers, rng: np.random.Generator) -> list[Array]:
    """Return the pieces, (frames, 52) each, followed by `levers.copies` variants of each or of each stretch of it,
    all within 0..1."""
    result = list(pieces)
    for piece in pieces:
        for _ in range(levers.copies):
            result += [_variant(part, pieces, levers, rng) for part in _stretches(piece, levers.stretch)]
    return result


def _stretches(piece: Array, frames: int) -> list[Array]:
    """Cut a piece into near-equal stretches of about `frames`; all of it where that is 0."""
    return np.array_split(piece, max(1, round(len(piece) / frames))) if frames else [piece]


def _variant(piece: Array, pieces: Sequence[Array], levers: Levers, rng: np.random.Generator) -> Array:
    variant = _warped(piece, levers.warp, rng)
    if rng.random() < levers.mix:
        other = _fitted(pieces[int(rng.integers(len(pieces)))], len(variant), rng)
        share = rng.uniform(0.2, 0.8)
        variant = share * variant + (1 - share) * other
    if rng.random() < levers.recombine:
        other = _fitted(pieces[int(rng.integers(len(pieces)))], len(variant), rng)
        variant = np.where(LOWER, variant, other)
    if levers.mirror and rng.random() < 0.5:
        variant = mirrored(variant)
    return np.asarray(np.clip(variant * _gains(levers.gain, rng), 0.0, 1.0))


def _gains(strength: float, rng: np.random.Generator) -> Array:
    shared = rng.standard_normal(len(SHAPES))
    shared = (shared + shared[MIRROR]) / np.sqrt(2)
    shared[np.arange(len(SHAPES)) == MIRROR] /= np.sqrt(2)
    return np.asarray(np.exp(strength * (0.9 * shared + 0.3 * rng.standard_normal(len(SHAPES)))))


def _warped(piece: Array, strength: float, rng: np.random.Generator) -> Array:
    if not strength:
        return piece
    knots = max(2, len(piece) // 60)
    tempo = np.interp(
        np.arange(len(piece)), np.linspace(0, len(piece), knots), 1 + strength * rng.uniform(-1, 1, knots)
    )
    at = np.cumsum(tempo) - tempo[0]
    return interpolate(piece, at[at <= len(piece) - 1])


def _fitted(piece: Array, frames: int, rng: np.random.Generator) -> Array:
    """Return a random stretch of a piece with a given length, running to and fro where it is shorter."""
    there_and_back = np.concatenate([piece, piece[::-1]])
    repeats = -(-(frames + len(there_and_back)) // len(there_and_back))
    start = int(rng.integers(len(there_and_back)))
    return np.tile(there_and_back, (repeats, 1))[start : start + frames]
