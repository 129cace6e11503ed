"""What speeds are measured with: a figure beside its goal, percentiles, and performances of any length."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from engine.lab.performer import demo
from engine.take import MODEL_FPS, Take


@dataclass(frozen=True)
class Speed:
    """One measured figure beside what it should reach; `at_least` where more is better."""

    name: str
    value: float
    unit: str
    goal: float
    at_least: bool = False


def percentile_ms(job: Callable[[int], object], rounds: int, *, percentile: float = 95.0) -> float:
    """Run `job(round)` a number of times after two to warm up; return a percentile of its wall time in milliseconds."""
    job(0)
    job(1)
    spent = []
    for index in range(rounds):
        began = time.perf_counter()
        job(index)
        spent.append(time.perf_counter() - began)
    return float(np.percentile(spent, percentile) * 1e3)


def performance_of(seconds: float, fps: float = MODEL_FPS) -> Take:
    """Return the demo performance, repeated to a length, as a take."""
    weights = demo.performance().weights
    frames = round(seconds * fps)
    return Take(weights=np.tile(weights, (-(-frames // len(weights)), 1))[:frames], fps=fps, name="repeated")
