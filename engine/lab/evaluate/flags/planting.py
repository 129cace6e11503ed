"""What plants of faults have in common: the excerpt with its fault, and a place that is free for one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from engine.extended import bundled_face
from engine.quality import Seen
from engine.take import Array

EDGE_S = 1.0  # nothing is planted nearer to the ends of an excerpt


@dataclass(frozen=True, eq=False)
class Planted:
    """An excerpt with a fault on the frames start to stop (half-open)."""

    seen: Seen
    start: int
    stop: int


# Puts a fault into an excerpt; None where this one gives no occasion for it.
Plant = Callable[[Seen, np.random.Generator], Planted | None]


def with_rows(seen: Seen, weights: Array) -> Seen:
    """Return the same excerpt with other weights, (frames, 52), measured anew."""
    return replace(seen, weights=weights, controls=bundled_face().measure(weights))


def free_range(seen: Seen, rng: np.random.Generator, least_s: float, most_s: float) -> tuple[int, int] | None:
    """Return a random range without lost frames."""
    edge = seen.frames(EDGE_S)
    for _ in range(50):
        length = max(1, round(rng.uniform(least_s, most_s) * seen.fps))
        if seen.length - 2 * edge <= length:
            return None
        start = int(rng.integers(edge, seen.length - edge - length))
        if not seen.lost[start - 3 : start + length + 3].any():
            return start, start + length
    return None
