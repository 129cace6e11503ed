"""Systems to solve, and which of their weights are held."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from engine.spacetime.system import Position
from engine.take import Array, Mask

sys.path.insert(0, str(Path(__file__).parent))


def basis_of(shapes: int, *, rank: int | None = None, markers: int = 20, seed: int = 0) -> Array:
    rng = np.random.default_rng(seed)
    basis = rng.normal(size=(3 * markers, shapes)) * rng.gamma(1.0, 2.0, size=shapes)
    if rank is not None:
        basis[:, rank:] = basis[:, :rank] @ rng.normal(size=(rank, shapes - rank))
    return basis


def source_of(frames: int, markers: int = 20, seed: int = 1) -> Array:
    return np.cumsum(np.random.default_rng(seed).normal(size=(frames, 3 * markers)), axis=0)


def held_at(frames: int, shapes: int, pinned: list[int]) -> tuple[Mask, Array]:
    held = np.zeros((frames, shapes), bool)
    held[pinned] = True
    return held, np.random.default_rng(2).random((frames, shapes))


PINS = {
    "first": [0],
    "last": [-1],
    "both ends": [0, -1],
    "middle": [5],
    "adjacent": [0, 5, 6, 7, -1],
    "none": [],
}


def positions_of(frames: int, shapes: int, *, by_frame: bool) -> tuple[Position, Array]:
    rng = np.random.default_rng(4)
    weights = rng.random((frames, 9)) * (rng.random((frames, 9)) < 0.3) if by_frame else rng.random(9)
    return Position(rng.normal(size=(9, shapes)), 5 * weights), rng.normal(size=(frames, 9))
