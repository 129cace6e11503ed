"""BSS20 table 3: how many Bézier points a hand edit would need for what a fill makes, and how long the fill takes."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

from engine.inpaint.infer import bundled
from engine.lab.corpus import pieces_to_measure
from engine.lab.evaluate.inpaint.table import guided, holes
from engine.lab.reporting import Report, Row
from engine.take import Array

TOLERANCE = 0.01
CASES = (("viseme editing", 19, "visemes"), ("occlusion completion", 62, "none"), ("noisy-based", 116, "noisy"))


def table(data: Path | None, report: Report) -> list[Row]:
    """Return a row per case of the paper: frames, mean Bézier points per moving curve, their error, our milliseconds."""
    pieces = [piece for piece in pieces_to_measure(data) if piece.whole_face]
    rows = []
    for name, frames, kind in CASES:
        found = holes(pieces, frames, 10)
        rng = np.random.default_rng(0)
        points, errors, spent = [], [], []
        for hole in found:
            gap = guided(hole, kind, rng)
            bundled().fill(gap)
            began = time.perf_counter()
            result = bundled().fill(gap)[0][hole.rows]
            spent.append((time.perf_counter() - began) * 1e3)
            fitted = [fit(curve) for curve in result.T if np.ptp(curve) > TOLERANCE]
            points += [count for count, _ in fitted]
            errors += [error for _, error in fitted]
        if found:
            rows.append(
                {
                    "name": name,
                    "frames": frames,
                    "bezier_points": float(np.mean(points)),
                    "error": float(np.mean(errors)),
                    "curves": len(points) / len(found),
                    "milliseconds": float(np.median(spent)),
                }
            )
        report(f"{name}: {len(found)} fills of {frames} frames")
    return rows


def fit(curve: Array, tolerance: float = TOLERANCE) -> tuple[int, float]:
    """Return how many on-curve points cubic Béziers need to follow a curve, (frames,), and their largest error.

    Greedy: each segment is as long as a least-squares cubic through its two ends stays within the tolerance, as
    Schneider 1990 fits drawn strokes; time runs evenly along a segment, as it does in a curve editor.
    """
    start, points, worst = 0, 1, 0.0
    while start < len(curve) - 1:
        stop, error = _longest(curve, start, tolerance)
        worst = max(worst, error)
        start = stop
        points += 1
    return points, worst


def _longest(curve: Array, start: int, tolerance: float) -> tuple[int, float]:
    """Return the last frame that one segment from `start` reaches, and its error; bisected between reached and missed."""
    reached, error = start + 1, 0.0
    step = 2
    missed = len(curve)
    while start + step < missed:
        off = _error(curve[start : start + step + 1])
        if off <= tolerance:
            reached, error = start + step, off
            step *= 2
        else:
            missed = start + step
    while missed - reached > 1:
        middle = (reached + missed) // 2
        off = _error(curve[start : middle + 1])
        if off <= tolerance:
            reached, error = middle, off
        else:
            missed = middle
    return reached, error


def _error(values: Array) -> float:
    at = np.linspace(0, 1, len(values))
    inner = np.stack([3 * at * (1 - at) ** 2, 3 * at**2 * (1 - at)], axis=1)
    ends = values[0] * (1 - at) ** 3 + values[-1] * at**3
    handles = np.linalg.lstsq(inner, values - ends, rcond=None)[0]
    return float(np.abs(ends + inner @ handles - values).max())
