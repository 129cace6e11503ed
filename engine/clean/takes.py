"""Cleans a recorded take, or a span of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from engine.clean.infer import Cleaner, bundled
from engine.clean.lag import lag_ms
from engine.easing import ease
from engine.errors import EditError
from engine.take import Array, Mask, Take, require_frames

Progress = Callable[[float], None]


@dataclass(frozen=True)
class Tuning:
    """Settings of cleaning a span; ranges tried were not recorded."""

    warm_up_s: float = 5.0  # seconds the network runs before a span, so that cleaning a span equals cleaning the take
    feather_s: float = 0.1  # seconds of the blend from raw to clean at the ends of a span


TUNING = Tuning()


@dataclass(frozen=True, eq=False)
class Cleaned:
    """A cleaned take and what was removed from it.

    Attributes
    ----------
    take : cleaned; known frames outside `touched` are bit-identical, and lost ones inside it are lost no more
    removed : (frames, 52) recorded weights minus cleaned ones
    lag_ms : lag of the cleaned span behind the recorded one; NaN where nothing moves
    touched : half-open range of frames
    """

    take: Take
    removed: Array
    lag_ms: float
    touched: tuple[int, int]


def clean(
    take: Take,
    *,
    strength: float = 1.0,
    frames: tuple[int, int] | None = None,
    cleaner: Cleaner | None = None,
    progress: Progress = lambda share: None,
) -> Cleaned:
    """Remove the tracker's noise from a take and keep the performance.

    Parameters
    ----------
    strength : 0 leaves the take as it is, 1 gives the network's estimate
    frames : half-open range to clean; None for the whole take
    progress : called with the share that is done, 0..1

    Raises
    ------
    EditError : for a strength outside 0..1 or a range outside the take
    """
    start, stop = frames or (0, len(take))
    if not 0.0 <= strength <= 1.0:
        raise EditError(f"A strength of {strength:g} is not between 0 and 1.")
    require_frames(take, start, stop)
    if strength == 0.0:
        return Cleaned(take, np.zeros(take.weights.shape), 0.0, (start, start))
    first = max(0, start - round(TUNING.warm_up_s * take.fps))
    times_s = np.arange(stop - first) / take.fps
    estimate = run(take.weights[first:stop], take.lost[first:stop], times_s, cleaner or bundled(), progress)
    weights = take.weights.copy()
    share = strength * _feather(len(take), start, stop, TUNING.feather_s * take.fps)[start:stop, None]
    weights[start:stop] += share * (estimate[start - first :] - weights[start:stop])
    lag = lag_ms(weights[start:stop], take.weights[start:stop], times_s[start - first :])
    cleaned = take.with_rows(start, weights[start:stop])
    return Cleaned(cleaned, take.weights - cleaned.weights, lag, (start, stop))


def run(weights: Array, lost: Mask, times_s: Array, cleaner: Cleaner, progress: Progress = lambda share: None) -> Array:
    """Return the causal estimate, (frames, 52), of tracked weights at their times."""
    steps = np.diff(times_s, prepend=times_s[0])
    state = cleaner.start(weights[0])
    estimate = np.empty(weights.shape)
    estimate[0] = state.output
    for index in range(1, len(weights)):
        state = cleaner.step(None if lost[index] else weights[index], float(steps[index]), state)
        estimate[index] = state.output
        if index % 1000 == 0:
            progress(index / len(weights))
    return estimate


def _feather(frames: int, start: int, stop: int, width: float) -> Array:
    """Return a window, (frames,), 1 within a range and 0 outside, with smooth ends except at the take's own."""
    frame = np.arange(frames)
    width = max(1.0, min(width, (stop - start) / 3))
    rise = np.ones(frames) if start == 0 else np.clip((frame - start + 1) / width, 0, 1)
    fall = np.ones(frames) if stop == frames else np.clip((stop - frame) / width, 0, 1)
    edge = np.minimum(rise, fall)
    return ease(edge)
