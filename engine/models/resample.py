"""Between a take's own frame rate and the rate at which the networks were trained."""

from __future__ import annotations

import numpy as np

from engine.take import MODEL_FPS, Array, Mask, Take


def to_model_rate(take: Take) -> tuple[Array, Mask]:
    """Return weights, (model frames, 52), and the lost mask of a take at `MODEL_FPS`; as they are if it has that rate."""
    if take.fps == MODEL_FPS:
        return take.weights, take.lost
    frames = model_frames(take)
    at = np.arange(frames, dtype=np.float64) * (take.fps / MODEL_FPS)
    lost = np.interp(at, np.arange(len(take)), take.lost.astype(float)) > 0
    return interpolate(take.weights, at), lost


def model_frames(take: Take) -> int:
    """Return how many frames a take has at the model rate: enough to reach its last frame."""
    return int(np.ceil((len(take) - 1) * MODEL_FPS / take.fps)) + 1


def interpolate(curves: Array, at: Array) -> Array:
    """Return linear interpolation of curves, (frames, n), at fractional frames, held beyond the ends."""
    at = np.clip(at, 0.0, len(curves) - 1)
    before = np.minimum(at.astype(np.int64), max(0, len(curves) - 2))
    part = (at - before)[:, None]
    after = np.minimum(before + 1, len(curves) - 1)
    return np.asarray((1 - part) * curves[before] + part * curves[after])


def from_model_rate(change: Array, take: Take) -> Array:
    """Return a change, (model frames, 52), at the take's own frames, (frames, 52)."""
    if take.fps == MODEL_FPS:
        return change
    return interpolate(change, np.arange(len(take), dtype=np.float64) * (MODEL_FPS / take.fps))
