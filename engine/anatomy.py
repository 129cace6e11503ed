"""Which shapes mirror each other, and pairs of shapes that exclude each other: what no face can do."""

from __future__ import annotations

import itertools
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from engine.take import SHAPE_INDEX, SHAPES, Array, Mask

Indices = npt.NDArray[np.int64]


def _other_side(name: str) -> str:
    if "Left" in name:
        return name.replace("Left", "Right")
    return name.replace("Right", "Left")


MIRROR: Indices = np.array([SHAPE_INDEX[_other_side(name)] for name in SHAPES])


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


@lru_cache(maxsize=1)
def pairs() -> tuple[tuple[int, int, int], ...]:
    """Return columns of two excluding shapes and their row in `EXCLUSIVE`.

    A shape with sides excludes its own side, one without excludes both.
    """
    found: list[tuple[int, int, int]] = []
    for row, (first, second, _) in enumerate(EXCLUSIVE):
        first_sides, second_sides = _sided(first), _sided(second)
        together = (
            zip(first_sides, second_sides, strict=True)
            if len(first_sides) == len(second_sides)
            else itertools.product(first_sides, second_sides)
        )
        found += [(SHAPE_INDEX[left], SHAPE_INDEX[right], row) for left, right in together]
    return tuple(found)


def clash(weights: Array) -> tuple[Array, Indices]:
    """Return how strong the strongest pair is on each frame of weights, (frames, 52), and its row in `EXCLUSIVE`.

    Both (frames,); a pair is as strong as the weaker of its shapes.
    """
    columns = np.ascontiguousarray(weights.T)
    strongest, which = np.full(len(weights), -np.inf), np.zeros(len(weights), np.int64)
    for first, second, row in pairs():
        strength = np.minimum(columns[first], columns[second])
        which[strength > strongest] = row
        np.maximum(strongest, strength, out=strongest)
    return strongest, which


def impossible(weights: Array) -> Mask:
    """Return which frames, (frames,) bool, of weights, (frames, 52), hold a pair of `EXCLUSIVE` shapes."""
    return np.asarray(clash(weights)[0] > BOTH)


def mirrored(weights: Array) -> Array:
    """Return weights, (frames, 52), of the face seen in a mirror; looking sideways needs no sign, its names are sided."""
    return np.asarray(weights[:, MIRROR])
