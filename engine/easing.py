"""Easing: the smooth step between two states."""

from __future__ import annotations

import numpy as np

from engine.take import Array


def ease(position: Array) -> Array:
    """Return the smooth step, 0 at 0 and 1 at 1 with no slope at either."""
    clipped = np.clip(position, 0.0, 1.0)
    return np.asarray(clipped * clipped * (3 - 2 * clipped))
