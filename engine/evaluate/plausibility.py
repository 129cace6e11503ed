"""Whether a face could be a recording: measured where no network of ours has a say.

Two figures. How far short stretches of motion are from the nearest recorded stretch, in millimetres of the bundled
head's surface; and how many frames hold two shapes that no face can make at once.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from engine.character import Character, bundled
from engine.models.windows import windows
from engine.take import SHAPE_INDEX, Array, Mask

STRETCH = 8  # frames, 0.27 s: about a syllable or a blink
STEP = 4
BOTH = 0.4  # two shapes that exclude each other are both this strong

# Shapes without a side stand for both sides, each with its own.
EXCLUSIVE: tuple[tuple[str, str, str], ...] = (
    ("eyeBlink", "eyeWide", "one muscle lowers the lid, its antagonist raises it"),
    ("browDown", "browOuterUp", "the brow cannot go down and up"),
    ("browDown", "browInnerUp", "the brow cannot go down and up"),
    ("jawLeft", "jawRight", "the jaw is on one side"),
    ("mouthLeft", "mouthRight", "the mouth is on one side"),
    ("mouthSmile", "mouthFrown", "the corner cannot rise and fall"),
    ("mouthFunnel", "mouthStretch", "lips are rounded forward or pulled wide"),
    ("mouthPucker", "mouthStretch", "lips are gathered or pulled wide"),
    ("mouthPucker", "mouthSmile", "lips are gathered or drawn apart by a broad smile"),
    ("mouthPucker", "mouthDimple", "corners are drawn in or drawn back"),
    ("mouthFunnel", "mouthDimple", "corners are drawn in or drawn back"),
    ("mouthPress", "mouthFunnel", "lips pressed on each other are not everted"),
    ("mouthPress", "mouthUpperUp", "lips pressed on each other are not raised"),
    ("mouthPress", "mouthLowerDown", "lips pressed on each other are not lowered"),
    ("mouthPress", "jawOpen", "lips do not reach each other over an open jaw"),
    ("mouthRollUpper", "mouthUpperUp", "a lip rolled in over the teeth is not raised off them"),
    ("mouthRollLower", "mouthLowerDown", "a lip rolled in over the teeth is not lowered off them"),
    ("cheekPuff", "jawOpen", "puffed cheeks need sealed lips"),
)


def _sided(name: str) -> list[str]:
    return [name] if name in SHAPE_INDEX else [f"{name}Left", f"{name}Right"]


def _pairs() -> list[tuple[int, int]]:
    """Return columns of excluding shapes; a shape with sides excludes its own side, one without excludes both."""
    found: list[tuple[int, int]] = []
    for first, second, _ in EXCLUSIVE:
        ones, others = _sided(first), _sided(second)
        together = zip(ones, others, strict=True) if len(ones) == len(others) else itertools.product(ones, others)
        found += [(SHAPE_INDEX[one], SHAPE_INDEX[other]) for one, other in together]
    return found


def impossible(weights: Array) -> Mask:
    """Return which frames, (frames,) bool, of weights, (frames, 52), hold a pair of `EXCLUSIVE` shapes."""
    first, second = np.array(_pairs()).T
    return np.asarray((np.minimum(weights[:, first], weights[:, second]) > BOTH).any(axis=1))


@dataclass(frozen=True, eq=False)
class Recorded:
    """Stretches of recorded motion, and the distance to the nearest of them.

    Attributes
    ----------
    columns : shapes that are compared
    metric : (columns, rank) float64; weights times this are coordinates in which distance is mm of the surface
    bank : (stretches, STRETCH * rank) float32
    """

    columns: Array
    metric: Array
    bank: Array

    def distance_mm(self, weights: Array) -> Array:
        """Return how far each stretch of weights, (frames, 52), is from the nearest recorded one, in mm.

        The root mean square over the stretch's frames and the moving surface's vertices.
        """
        asked = _stretches(weights, self.columns, self.metric)
        squares = (asked**2).sum(axis=1)[:, None] - 2 * asked @ self.bank.T + (self.bank**2).sum(axis=1)
        return np.asarray(np.sqrt(np.maximum(squares.min(axis=1), 0.0) / STRETCH))


def recorded(pieces: Sequence[Array], columns: Array, character: Character | None = None) -> Recorded:
    """Return the stretches of recorded pieces, (frames, 52) each, compared by some shape columns."""
    deltas = (character or bundled()).deltas[columns].astype(np.float64)
    moving = np.abs(deltas).max(axis=(0, 2)) > 0.1
    gram = np.einsum("svx,tvx->st", deltas[:, moving], deltas[:, moving]) / moving.sum()
    values, vectors = np.linalg.eigh(gram)
    kept = values > 1e-6 * values.max()
    metric = vectors[:, kept] * np.sqrt(values[kept])
    bank = np.concatenate([_stretches(piece, columns, metric) for piece in pieces])
    return Recorded(columns, metric, bank)


def _stretches(weights: Array, columns: Array, metric: Array) -> Array:
    cut = windows(weights[:, columns] @ metric, length=STRETCH, overlap=1 - STEP / STRETCH)
    return np.asarray(cut.reshape(len(cut), -1), np.float32)
