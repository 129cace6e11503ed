"""How long a fill takes: 200 frames with pins (BSS20 table 3 reports 120 to 140 ms)."""

from __future__ import annotations

import numpy as np

from engine.controls import CONTROL_INDEX, FEW, bundled_measurer
from engine.inpaint.fill import fill
from engine.lab.performer.corpus import synthetic_performances
from engine.lab.speed.timing import Speed, percentile_ms
from engine.take import MODEL_FPS, Take

FRAMES, GOAL_MS = 200, 40.0


def measure() -> list[Speed]:
    """Return the time of a fill of 200 frames through eight whole poses, of six variants, and under three curves."""
    take = Take(np.concatenate(synthetic_performances(0.5, seed=1)), MODEL_FPS)
    span = (150, 150 + FRAMES)
    pins = {frame: take.weights[frame] for frame in range(span[0] + 12, span[1], 25)}
    latency_ms = percentile_ms(lambda index: fill(take, span, pins=pins, seed=index), 30)
    six = percentile_ms(lambda index: fill(take, span, pins=pins, seed=index, variants=6), 10)
    few = {name: bundled_measurer().measure(take.weights[slice(*span)])[:, CONTROL_INDEX[name]] for name in FEW}
    steered = percentile_ms(lambda index: fill(take, span, controls=few, seed=index), 30)
    return [
        Speed("fill_200_ms_p95", latency_ms, "ms", GOAL_MS),
        Speed("fill_200_six_variants_ms_p95", six, "ms", 6 * GOAL_MS),
        Speed("fill_200_three_controls_ms_p95", steered, "ms", GOAL_MS),
    ]
