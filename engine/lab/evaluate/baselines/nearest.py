"""The nearest recorded moment: nothing is learnt, and nothing can ship, since the training takes themselves are the model."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from engine.controls import bundled_measurer
from engine.lab.corpus import Piece, whole_faces
from engine.regress.areas import AREAS
from engine.take import SHAPES, Array

CONTEXT = (-4, -2, 0, 2, 4)  # frames around the one that is looked up


class Nearest:
    """Weights of the training frame whose controls, and those of its neighbours in time, come nearest.

    Parameters
    ----------
    pieces : recorded training pieces
    """

    def __init__(self, pieces: Sequence[Piece]) -> None:
        self._trees: dict[str, tuple[cKDTree, Array, Array]] = {}
        for area in AREAS:
            chosen = whole_faces(pieces) if area.needs_whole_face else pieces
            weights = np.concatenate([piece.weights for piece in chosen])
            controls = [bundled_measurer().measure(piece.weights)[:, area.control_columns] for piece in chosen]
            scale = np.concatenate(controls).std(axis=0)
            tree = cKDTree(np.concatenate([_in_context(curves / scale) for curves in controls]))
            self._trees[area.name] = tree, scale, weights[:, area.shape_columns]

    def infer(self, controls: Array) -> Array:
        """Return weights, (frames, 52), of controls, (frames, 8) in mm; shapes of no area are zero."""
        result = np.zeros((len(controls), len(SHAPES)))
        for area in AREAS:
            tree, scale, weights = self._trees[area.name]
            _, index = tree.query(_in_context(controls[:, area.control_columns] / scale))
            result[:, area.shape_columns] = weights[index]
        return result


def _in_context(curves: Array) -> Array:
    at = np.clip(np.arange(len(curves))[:, None] + np.array(CONTEXT), 0, len(curves) - 1)
    return np.asarray(curves[at].reshape(len(curves), -1))
