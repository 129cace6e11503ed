"""Lips close no further than the jaw has opened: mouthClose takes back the jaw's motion on the lips.

Without the jaw it would turn them inside out, so a character is drawn, and its controls are measured, with
``close = min(mouthClose, max(jawOpen, 0))`` in place of mouthClose. Where mouthClose is ahead of the jaw, it follows the
jaw, and so do derivatives.
"""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from engine.take import SHAPE_INDEX, Array, Mask

JAW, CLOSE = SHAPE_INDEX["jawOpen"], SHAPE_INDEX["mouthClose"]
Weights = TypeVar("Weights", bound=npt.NDArray[Any])


def limited(weights: Weights) -> Weights:
    """Return weights, (..., 52), whose lips close no further than the jaw has opened, as the character is drawn."""
    drawn = weights.copy()
    drawn[..., CLOSE] = np.minimum(weights[..., CLOSE], np.maximum(weights[..., JAW], 0.0))
    return drawn


def drawable(weights: Weights) -> Weights:
    """Return weights, (..., 52), limited to what a mesh can show: 0..1, and lips that close no further than the jaw."""
    used = weights.copy()
    np.clip(used, 0.0, 1.0, out=used)
    used[..., CLOSE] = np.minimum(used[..., CLOSE], used[..., JAW])
    return used


def excess(weights: Array) -> Array:
    """Return by how much the lips would close further than the jaw has opened, (...,), negative where they do not."""
    return np.asarray(weights[..., CLOSE] - np.maximum(weights[..., JAW], 0.0))


def ahead(weights: Array) -> Mask:
    """Return in which frames, (frames,), mouthClose is ahead of the jaw and follows that instead of its own weight."""
    return np.asarray(weights[:, CLOSE] > weights[:, JAW])


def follow(slopes: Array, weights: Array) -> None:
    """Move d / d mouthClose over to d / d jawOpen, in place, in those frames of slopes, (frames, n, 52)."""
    joined = ahead(weights)
    slopes[joined, :, JAW] += slopes[joined, :, CLOSE]
    slopes[joined, :, CLOSE] = 0.0
