from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from engine.lab.corpus import Piece
from engine.lab.evaluate.intervals import STRETCH, Row, intervals_of
from engine.take import SHAPES, Array


def _mean(made: Sequence[Array], pieces: Sequence[Piece]) -> Row:
    return {"mean": float(np.concatenate(made).mean()), "none": None}


def test_alike_stretches_leave_no_doubt_and_unlike_ones_do() -> None:
    alike = np.full((8 * STRETCH, len(SHAPES)), 0.3)
    unlike = np.repeat(np.arange(8) % 2, STRETCH)[:, None] * np.ones(len(SHAPES))
    pieces = [Piece(alike, True, "someone")]
    sure, unsure = (intervals_of(_mean, [made], pieces) for made in (alike, unlike))
    np.testing.assert_allclose([sure["mean_low"], sure["mean_high"]], 0.3)
    assert 0.0 < unsure["mean_low"] < 0.3 and 0.7 < unsure["mean_high"] < 1.0
    assert "none_low" not in unsure
