"""The soft brush: how far each frame follows the pointer."""

from __future__ import annotations

import numpy as np

from engine.take import Array


def falloff(frames: Array, centre: float, radius_frames: float) -> Array:
    """Return how much each frame follows, 1 at the centre and 0 from the radius on, flat at both ends."""
    away = np.clip(np.abs(frames - centre) / max(radius_frames, 1e-9), 0.0, 1.0)
    return np.asarray(1 - away * away * (3 - 2 * away))


def pulled(
    curve: Array, start: int, centre: int, *, by: float, radius_frames: int, strength: float, lowest: float = 0.0
) -> Array:
    """Return rows of a curve, (n,) from frame `start`, pulled at `centre`, nowhere below its lowest value."""
    frames = np.arange(start, start + len(curve), dtype=np.float64)
    return np.asarray(np.maximum(lowest, curve + strength * by * falloff(frames, centre, radius_frames)))


def reach(centre: int, radius_frames: int, frames: int) -> tuple[int, int]:
    """Return the half-open range of frames that the brush moves, within a take of a number of frames."""
    return max(0, centre - radius_frames + 1), min(frames, centre + radius_frames)


def eased_to(curve: Array, frames: tuple[int, int], value: float, *, ease_frames: int) -> tuple[int, Array]:
    """Return first frame and rows, (n,), of a curve set to a value over a range and eased in and out beside it."""
    first, last = max(0, frames[0] - ease_frames), min(len(curve), frames[1] + ease_frames)
    frame = np.arange(first, last, dtype=np.float64)
    away = np.maximum(0.0, np.maximum(frames[0] - frame, frame - frames[1] + 1))
    follows = falloff(away, 0.0, ease_frames + 1)
    return first, curve[first:last] + follows * (value - curve[first:last])
