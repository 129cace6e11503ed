"""Windows over curves: what the networks are trained on."""

from __future__ import annotations

import numpy as np

from engine.take import Array


def windows(curves: Array, *, length: int, overlap: float) -> Array:
    """Return overlapping windows, (windows, length, n), of curves, (frames, n); short curves are held at their end."""
    if len(curves) < length:
        curves = np.concatenate([curves, np.repeat(curves[-1:], length - len(curves), axis=0)])
    step = max(1, round(length * (1 - overlap)))
    starts = np.arange(0, len(curves) - length + 1, step)
    return np.asarray(curves[starts[:, None] + np.arange(length)])
