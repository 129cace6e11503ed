"""A target pose: some weights of a frame, or all."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from engine.errors import EditError
from engine.take import SHAPE_INDEX, SHAPES, Array

FARTHEST = 1e4  # a weight beyond this is a slip, and far beyond it overflows
Pose = Mapping[str, float] | Array  # weights by shape, or (52,) with NaN for what is free


def filled(pose: Pose) -> Array:
    """Return a pose as (52,), NaN for what is free; raises `EditError` for unknown shapes and what is no number."""
    if not isinstance(pose, Mapping):
        weights = np.asarray(pose, np.float64)
        if weights.shape != (len(SHAPES),) or (np.abs(weights) > FARTHEST).any():
            raise EditError(f"A pose needs {len(SHAPES)} finite weights, this one has {weights.size}.")
        return weights
    weights = np.full(len(SHAPES), np.nan)
    for shape, value in pose.items():
        if shape not in SHAPE_INDEX:
            raise EditError(f"There is no shape called {shape!r}.", "Shapes have ARKit names, such as jawOpen.")
        if not abs(value) <= FARTHEST:
            raise EditError(f"The weight of {shape} is not a number that a face could take.", "Weights lie in 0..1.")
        weights[SHAPE_INDEX[shape]] = value
    return weights
