"""Editing weights directly: curves pulled by hand, ranges pasted, Butterworth smoothing. No network is involved."""

from __future__ import annotations

import numpy as np

from engine.easing import ease
from engine.errors import EditError
from engine.patch import Patch
from engine.take import SHAPES, Array, Mask, Take, require_frames

PASTE_FEATHER_S = 0.13  # beside what is pasted; four frames at 30 fps, as long as a lip takes to open
SMOOTH_FEATHER_S = 0.15  # within a smoothed range, at either end
LOWEST_HZ = 0.001
ORDER = 2  # filtered once in each direction, so the slope is that of order 4 and nothing shifts in time


def _patch(take: Take, start: int, weights: Array, *, found: Mask | None = None) -> Patch:
    """Return a patch without control targets."""
    return Patch.between(take, take.with_rows(start, weights, found=found), (start, start + len(weights)))


def replace_weight(take: Take, shape: int, start: int, curve: Array) -> Patch:
    """Put a curve, (n,), in place of one weight from frame `start`, kept within the range 0..1 or the recorded one."""
    stop = start + len(curve)
    require_frames(take, start, stop)
    if not 0 <= shape < len(SHAPES):
        raise EditError(f"There is no shape {shape}.", f"Shapes are counted from 0 to {len(SHAPES) - 1}.")
    if not np.isfinite(curve).all():
        raise EditError("A weight must be a finite number.")
    weights = take.weights[start:stop].copy()
    was = weights[:, shape]
    weights[:, shape] = np.where(curve == was, was, np.clip(curve, np.minimum(was, 0.0), np.maximum(was, 1.0)))
    return _patch(take, start, weights)


def paste(take: Take, start: int, weights: Array, *, feather_s: float = PASTE_FEATHER_S) -> Patch:
    """Put copied weights, (n, 52), in place from frame `start`; the frames beside them ease over to the take.

    Every pasted frame is as it was copied, so that a single pasted pose is met. Over `feather_s` beside it the take is
    moved by the step at that end, ever less: it keeps its own motion. What would lie beyond the take's end is left out;
    raises `EditError` where nothing is left.
    """
    pasted = weights[: max(0, len(take) - start)]
    if start < 0 or not len(pasted) or pasted.shape[1] != len(SHAPES):
        raise EditError("There is no room to paste here.", "Move the playhead into the take.")
    feather, stop = round(feather_s * take.fps), start + len(pasted)
    first, last = max(0, start - feather), min(len(take), stop + feather)
    rows = take.weights[first:last].copy()
    rows[start - first : stop - first] = pasted
    found = np.zeros(len(rows), bool)
    found[start - first : stop - first] = True
    for beside, edge, value in (
        (slice(first, start), start, pasted[0]),
        (slice(stop, last), stop - 1, pasted[-1]),
    ):
        frame = np.arange(beside.start, beside.stop)
        share = ease(1 - np.abs(frame - edge) / (feather + 1))[:, None]
        present = take.weights[beside]
        moved = present + share * (value - take.weights[edge])
        kept = np.clip(moved, np.minimum(present, 0.0), np.maximum(present, 1.0))
        rows[frame - first] = np.where(share > 0, kept, present)
    return _patch(take, first, rows, found=found)


def smooth(take: Take, frames: tuple[int, int], cutoff_hz: float, *, feather_s: float = SMOOTH_FEATHER_S) -> Patch:
    """Low-pass all weights over a range of frames with a Butterworth filter of zero phase, its ends feathered.

    The filter runs over the take around the range, so that the range's ends need no guess of what lies beyond.
    Raises `EditError` for a cutoff that is not between 0 and half the frame rate.
    """
    from scipy.signal import butter, sosfiltfilt  # here: asking for a paste needs no filters

    start, stop = frames
    require_frames(take, start, stop)
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
