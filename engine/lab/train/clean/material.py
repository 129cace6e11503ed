"""Spoilt performances whose truth is known: to train on, to tune on and to measure with."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from engine.lab.performer.degrade import Faults, Tracked, changing_times, degrade
from engine.take import Array

CHANGING = 0.0  # stands for a frame rate that changes


@dataclass(frozen=True, eq=False)
class Spoilt:
    """A performance and what a tracker makes of it.

    Attributes
    ----------
    truth : (frames, 52)
    times_s : (frames,)
    tracked : what the tracker delivers
    source : name of the take
    """

    truth: Array
    times_s: Array
    tracked: Tracked
    source: str


def spoil(
    performances: Iterable[tuple[Array, float, str]], fps: float, *, seed: int, faults: Faults | None = None
) -> list[Spoilt]:
    """Return performances (weights, their rate, their name) at another rate, spoilt; the same seed spoils alike."""
    result = []
    for index, (weights, own_fps, source) in enumerate(performances):
        rng = np.random.default_rng([seed, index, round(fps)])
        duration_s = (len(weights) - 1) / own_fps
        times = changing_times(duration_s, rng) if fps == CHANGING else np.arange(0.0, duration_s, 1 / fps)
        truth = np.clip(cubic(weights, times * own_fps), 0.0, 1.0)
        result.append(Spoilt(truth, times, degrade(truth, times, faults or Faults(), rng), source))
    return result


def cubic(curves: Array, at: Array) -> Array:
    """Return Catmull-Rom interpolation of curves, (frames, n), at fractional frames: above their rate, no corners."""
    before = np.clip(at.astype(np.int64), 0, len(curves) - 2)
    part = (at - before)[:, None]
    p0, p1, p2, p3 = (curves[np.clip(before + step, 0, len(curves) - 1)] for step in (-1, 0, 1, 2))
    slope1, slope2 = (p2 - p0) / 2, (p3 - p1) / 2
    change = p2 - p1
    third, second = slope1 + slope2 - 2 * change, 3 * change - 2 * slope1 - slope2
    return np.asarray(p1 + part * (slope1 + part * (second + part * third)))
