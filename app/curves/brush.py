"""The soft brush: how far each frame follows the pointer. Radii are in frames, as many as the brush's seconds come to."""

from __future__ import annotations

import numpy as np

from engine.easing import ease
from engine.take import Array


def falloff(frames: Array, centre: float, radius_frames: float) -> Array:
    """Return how much each frame follows, 1 at the centre and 0 from the radius on, flat at both ends."""
    away = np.clip(np.abs(frames - centre) / max(radius_frames, 1e-9), 0.0, 1.0)
    return np.asarray(1 - ease(away))


def pulled(
    curve: Array,
    start: int,
    centre: int,
    *,
    by: float,
    radius_frames: float,
    strength: float,
    floor: float = 0.0,
    ceiling: float = np.inf,
) -> Array:
    """Return rows of a curve, (n,) from frame `start`, pulled at `centre` within a floor and a ceiling.

    With d how far the centre goes and h its height over the floor, a frame of height h' goes down by
    min(f d, h' d / h), f its falloff: nowhere by a greater share of its height than the centre. So the whole nears the
    floor together: were all to go down as far and be cut there, a peak would be left standing on it as a needle. Where
    that is no bound, what a pull did is undone by the pull back. Going up is the same towards a ceiling.
    """
    frames = np.arange(start, start + len(curve), dtype=np.float64)
    by, follows = strength * by, falloff(frames, centre, radius_frames)
    room = np.maximum(0.0, curve - floor if by < 0 else ceiling - curve)
    at_centre = float(room[centre - start])
    if not np.isfinite(at_centre):
        return np.asarray(curve + by * follows)
    share = min(1.0, abs(by) / at_centre) if at_centre > 0 else 1.0
    return np.asarray(curve + np.sign(by) * np.minimum(abs(by) * follows, share * room))


def reach(centre: int, radius_frames: float, frames: int) -> tuple[int, int]:
    """Return the half-open range of frames that the brush moves, within a take of a number of frames."""
    away = max(1, int(np.ceil(radius_frames)))
    return max(0, centre - away + 1), min(frames, centre + away)


def eased_to(
    curve: Array, frames: tuple[int, int], values: Array | float, *, before_frames: float, after_frames: float
) -> tuple[int, Array]:
    """Return first frame and rows, (n,), of a curve that has `values` over a range and is eased in and out beside it.

    Every eased row lies between what was there and the nearest of the values, so that nothing overshoots.
    """
    first = max(0, frames[0] - int(np.ceil(before_frames)))
    last = min(len(curve), frames[1] + int(np.ceil(after_frames)))
    rows = curve[first:last].copy()
    inside = np.broadcast_to(np.asarray(values, np.float64), (frames[1] - frames[0],))
    at = np.arange(first, last, dtype=np.float64)
    for beside, edge, value, width in (
        (at < frames[0], frames[0], inside[0], before_frames),
        (at >= frames[1], frames[1] - 1, inside[-1], after_frames),
    ):
        rows[beside] += falloff(at[beside], edge, width) * (value - rows[beside])
    rows[frames[0] - first : frames[1] - first] = inside
    return first, rows
