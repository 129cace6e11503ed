"""One drag step: asked curves in, new weights and their controls out."""

from __future__ import annotations

from engine import editing
from engine.lab.speed.timing import Speed, percentile_ms, performance_of
from engine.take import Take

ROUNDS = 200
BRUSH_FRAMES = 15


def drag_ms(take: Take, rounds: int = ROUNDS) -> float:
    """Return the 95th percentile of a drag step in milliseconds; the lips are pulled a little further each time."""
    editing.warm_up()
    dragger = editing.Dragger(take)
    start = len(take) // 2

    def step(index: int) -> None:
        asked = dragger.controls[start : start + 2 * BRUSH_FRAMES].copy()
        asked[:, 0] += 0.05 * (index + 1)
        dragger.drag(start, asked)

    return percentile_ms(step, rounds)


def measure() -> list[Speed]:
    """Measure on 8 s and on 60 min, where the step must cost hardly more."""
    short, long = drag_ms(performance_of(8.0)), drag_ms(performance_of(3600.0))
    return [
        Speed("drag_8s_ms_p95", short, "ms", 10.0),
        Speed("drag_60min_ms_p95", long, "ms", 13.0),
        Speed("drag_60min_ratio", long / short, "", 1.3),
    ]
