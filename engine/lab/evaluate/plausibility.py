"""Whether a face could be a recording: measured where no network of ours has a say.

How far short stretches of motion are from the nearest recorded stretch, in millimetres of the bundled head's surface.
How many frames hold two shapes that no face can make at once is the other figure: `engine.anatomy`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from engine.character import Character, bundled
from engine.models.windows import windows
from engine.take import Array

STRETCH = 8  # frames, 0.27 s: about a syllable or a blink
STEP = 4


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
