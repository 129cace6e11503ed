"""Where face and sound do not go together: a take that ends before its sound, lips out of step with loudness."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from engine.quality.lips import LIPS
from engine.quality.record import Flag, weight_of
from engine.quality.seen import Seen
from engine.take import Array


def short(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield the last frame of a take that ends before its sound."""
    if seen.sound is None:
        return
    missing_s = seen.sound.offset_s + seen.sound.duration_s - seen.length / seen.fps
    if missing_s > seen.tuning.short_s:
        text = f"The sound goes on for {missing_s:.2f} s after the take ends."
        weight = weight_of(missing_s, seen.tuning.short_s, seen.tuning.full_short_s)
        yield Flag("short", seen.length - 1, seen.length, weight, text)


def out_of_step(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield the whole take where its lips go with the loudness of another moment."""
    found = offset_of(seen)
    if found is None:
        return
    offset_s, best, none = found
    if (
        abs(offset_s) > seen.tuning.out_of_step_s
        and best > seen.tuning.step_correlation
        and best - none > seen.tuning.step_gain
    ):
        way = "after" if offset_s > 0 else "before"
        text = f"The lips move {abs(offset_s):.2f} s {way} the sound (correlation {best:.2f}, {none:.2f} as it is)."
        weight = weight_of(abs(offset_s), seen.tuning.out_of_step_s, seen.tuning.full_out_of_step_s)
        yield Flag("sound", 0, seen.length, weight, text)


def offset_of(seen: Seen) -> tuple[float, float, float] | None:
    """Return by how many seconds the lips are late, how they correlate with the loudness then, and as they are.

    The offset is the lag within `step_range_s` at which lip opening and the logarithm of loudness correlate best; None
    where there is no sound, or too little in common, or nothing moves.
    """
    if seen.sound is None:
        return None
    begin = round(seen.sound.offset_s * seen.fps)
    first, last = max(0, begin), min(seen.length, begin + len(seen.sound.loudness))
    if last - first < seen.tuning.step_least_s * seen.fps:
        return None
    loud = seen.sound.loudness[first - begin : last - begin]
    loud = np.log(loud + 1e-2 * max(float(loud.max()), 1e-9))
    lips = seen.controls[first:last, LIPS]
    return _best_lag(lips, loud, seen.frames(seen.tuning.step_range_s), seen.fps)


def _best_lag(lips: Array, loud: Array, furthest: int, fps: float) -> tuple[float, float, float] | None:
    if lips.std() < 1e-6 or loud.std() < 1e-6:
        return None
    count = len(lips) - 2 * furthest
    core, lips = loud[furthest : furthest + count], np.ascontiguousarray(lips - lips.mean())
    core = core - core.mean()
    sums, squares = (np.append(0.0, np.cumsum(values)) for values in (lips, lips**2))
    spread = np.diff([squares[: 2 * furthest + 1], squares[count:]], axis=0)[0]
    spread -= np.diff([sums[: 2 * furthest + 1], sums[count:]], axis=0)[0] ** 2 / count
    size = np.sqrt(np.maximum(spread, 1e-12) * max(float(core @ core), 1e-12))
    corr = np.correlate(lips, core, mode="valid") / size  # at each lag, -furthest to furthest
    best = int(np.argmax(corr))
    return (best - furthest) / fps, float(corr[best]), float(corr[furthest])
