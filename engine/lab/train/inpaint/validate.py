"""Figures on validation takes, by which a training run is judged: never on test takes."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from engine.inpaint.gap import Gap, gap_of
from engine.inpaint.infer import Filler
from engine.inpaint.regions import REGIONS
from engine.inpaint.seams import bridge_weights
from engine.lab.corpus import Piece, rest_of
from engine.lab.evaluate.inpaint.motion import npss
from engine.take import MODEL_FPS, Array, Mask

SPANS_S = (0.2, 0.5, 1.0, 2.0, 3.0)
CONTEXT = 60  # frames on either side, as in use


def validation_gaps(
    pieces: Sequence[Piece], frames: int, others: Sequence[Piece] = ()
) -> list[tuple[Array, Mask, Gap]]:
    """Return truth, hole and unguided gap at regular places of the pieces, the mouth alone where only it moves.

    `others` are further pieces of the same takes, which may lend motion.
    """
    found = []
    for piece in pieces:
        region = REGIONS["face" if piece.whole_face else "lower"]
        for start in range(15, len(piece.weights) - frames - 15, max(frames, 30)):
            first, last = max(0, start - CONTEXT), min(len(piece.weights), start + frames + CONTEXT)
            truth = piece.weights[first:last]
            hole = np.zeros(truth.shape, bool)
            hole[start - first : start - first + frames, region] = True
            rest = rest_of([*pieces, *others], piece, start, start + frames)
            found.append((truth, hole, gap_of(np.where(hole, np.nan, truth), rest=rest)))
    return found


def validation_figures(filler: Filler, pieces: Sequence[Piece], others: Sequence[Piece] = ()) -> dict[str, list[float]]:
    """Return MAE, velocity MAE and NPSS of unguided fills for each of `SPANS_S`, beside the plain bridge's."""
    figures: dict[str, list[float]] = {}
    ways: dict[str, Callable[[Gap], Array]] = {
        "network": lambda gap: filler.fill(gap)[0],
        "bridge": lambda gap: bridge_weights(gap.known),
    }
    for span in SPANS_S:
        gaps = validation_gaps(pieces, round(span * MODEL_FPS), others)
        for way, make in ways.items():
            pairs = [(truth, hole, make(gap)) for truth, hole, gap in gaps]
            for name, value in _figures(pairs).items():
                figures.setdefault(f"{way}_{name}", []).append(round(value, 5))
    return figures


def _figures(pairs: Sequence[tuple[Array, Mask, Array]]) -> dict[str, float]:
    off = np.concatenate([np.abs(result - truth)[hole] for truth, hole, result in pairs])
    moved = np.concatenate([np.abs(np.diff(result - truth, axis=0))[hole[1:]] for truth, hole, result in pairs])
    cut = [(truth[hole.any(axis=1)], result[hole.any(axis=1)]) for truth, hole, result in pairs]
    return {
        "mae": float(off.mean()),
        "velocity_mae": float(moved.mean()),
        "npss": npss([truth for truth, _ in cut], [result for _, result in cut]),
    }
