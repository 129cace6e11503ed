"""How sure a figure is: its spread when stretches of the takes are drawn anew (bootstrap, Efron 1979)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from engine.lab.corpus import Piece
from engine.take import MODEL_FPS, Array

Row = dict[str, Any]

STRETCH = round(10 * MODEL_FPS)  # frames; neighbouring ones err alike, so that single frames would look too sure
DRAWS, SEED = 200, 0
SHARE = 0.95


def intervals_of(
    measured: Callable[[Sequence[Array], Sequence[Piece]], Row], made: Sequence[Array], pieces: Sequence[Piece]
) -> Row:
    """Return the bounds of each figure of `measured` over draws of stretches, by its name and `_low` or `_high`.

    Stretches are drawn with replacement from all pieces, as many as there are; a figure that some draw does not have is
    bounded by the others.
    """
    parts = [
        (face[start : start + STRETCH], replace(piece, weights=piece.weights[start : start + STRETCH]))
        for face, piece in zip(made, pieces, strict=True)
        for start in range(0, len(face), STRETCH)
    ]
    rng = np.random.default_rng(SEED)
    found: dict[str, list[float]] = {}
    for _ in range(DRAWS):
        drawn = [parts[index] for index in rng.integers(len(parts), size=len(parts))]
        for name, value in measured([face for face, _ in drawn], [piece for _, piece in drawn]).items():
            if value is not None:
                found.setdefault(name, []).append(value)
    bounds: Row = {}
    for name, values in found.items():
        low, high = np.quantile(values, [(1 - SHARE) / 2, (1 + SHARE) / 2])
        bounds |= {f"{name}_low": float(low), f"{name}_high": float(high)}
    return bounds
