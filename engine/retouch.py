"""Editing weights directly: curves pulled by hand, ranges pasted, Butterworth smoothing. No network has a say."""

from __future__ import annotations

import numpy as np
from scipy.signal import butter, sosfiltfilt

from engine.easing import ease
from engine.editing import Patch
from engine.errors import EditError
from engine.extended import bundled_face
from engine.take import SHAPES, Array, Take

LOWEST_HZ = 0.001
ORDER = 2  # filtered once in each direction, so the slope is that of order 4 and nothing shifts in time


def _patch(take: Take, start: int, weights: Array) -> Patch:
    """Return a patch that asked nothing of the controls."""
    reached = bundled_face().measure(weights)
    return Patch(start, weights, np.full_like(reached, np.nan), reached)


def replace_weight(take: Take, shape: int, start: int, curve: Array) -> Patch:
    """Put a curve, (n,), in place of one weight from frame `start`, kept within the range 0..1 or the recorded one."""
    stop = start + len(curve)
    if not 0 <= start < stop <= len(take) or not 0 <= shape < len(SHAPES):
        raise EditError(f"Frames {start}:{stop} are not within the take, which has {len(take)} frames.")
    if not np.isfinite(curve).all():
        raise EditError("A weight must be a finite number.")
    weights = take.weights[start:stop].copy()
    was = weights[:, shape]
    weights[:, shape] = np.where(curve == was, was, np.clip(curve, np.minimum(was, 0.0), np.maximum(was, 1.0)))
    return _patch(take, start, weights)


def paste(take: Take, start: int, weights: Array, *, feather_frames: int = 4) -> Patch:
    """Put copied weights, (n, 52), in place from frame `start`, easing in and out over the first and last frames.

    What would lie beyond the take's end is left out; raises `EditError` where nothing is left.
    """
    pasted = weights[: max(0, len(take) - start)]
    if start < 0 or not len(pasted) or pasted.shape[1] != len(SHAPES):
        raise EditError("There is no room to paste here.", "Move the playhead into the take.")
    from_end = np.minimum(np.arange(len(pasted)), np.arange(len(pasted))[::-1])
    share = ease((from_end + 1) / (feather_frames + 1))[:, None]
    present = take.weights[start : start + len(pasted)]
    return _patch(take, start, np.where(share >= 1.0, pasted, present + share * (pasted - present)))


def smooth(take: Take, frames: tuple[int, int], cutoff_hz: float, *, feather_s: float = 0.15) -> Patch:
    """Low-pass all weights over a range of frames with a Butterworth filter of zero phase, its ends feathered.

    The filter runs over the take around the range, so that the range's ends need no guess of what lies beyond.
    Raises `EditError` for a cutoff that is not between 0 and half the frame rate.
    """
    start, stop = frames
    if not 0 <= start < stop <= len(take):
        raise EditError(f"Frames {start}:{stop} are not within the take, which has {len(take)} frames.")
    if not LOWEST_HZ <= cutoff_hz < take.fps / 2:
        raise EditError(f"The cutoff must be above {LOWEST_HZ:g} and below {take.fps / 2:g} Hz, half the frame rate.")
    if len(take) < 3:
        return _patch(take, start, take.weights[start:stop].copy())
    settle = int(np.ceil(2 * take.fps / cutoff_hz))
    first, last = max(0, start - settle), min(len(take), stop + settle)
    seen = take.weights[first:last]
    sections = butter(ORDER, cutoff_hz, fs=take.fps, output="sos")
    filtered = sosfiltfilt(sections, seen, axis=0, padlen=min(len(seen) - 1, 3 * ORDER + 3))
    present = take.weights[start:stop]
    frame = np.arange(stop - start)
    feather = feather_s * take.fps
    # an end of the take needs no feather: there is nothing to join
    into = np.full(len(frame), np.inf) if start == 0 else (frame + 1) / (feather + 1)
    out_of = np.full(len(frame), np.inf) if stop == len(take) else (frame[::-1] + 1) / (feather + 1)
    share = ease(np.minimum(np.minimum(into, out_of), 1.0))[:, None]
    smoothed = present + share * (filtered[start - first : stop - first] - present)
    return _patch(take, start, np.clip(smoothed, np.minimum(present, 0.0), np.maximum(present, 1.0)))
