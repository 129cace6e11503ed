"""Looking for what a reviewer should see, in an hour at 60 frames per second and again near an edit."""

from __future__ import annotations

import numpy as np

from engine.controls import bundled_measurer
from engine.lab.performer.degrade import Faults, degrade
from engine.lab.speed.timing import Speed, percentile_ms, performance_of
from engine.quality import Seen, Sound, flags_after, flags_of

FPS, DURATION_S = 60.0, 3600.0
EDIT_FRAMES = 60


def measure() -> list[Speed]:
    """Measure a full pass over an hour as a tracker delivers it, and one near an edit in the middle."""
    performance = performance_of(DURATION_S, FPS).weights
    frame = np.arange(len(performance))
    tracked = degrade(performance, frame / FPS, Faults(), np.random.default_rng(0))
    controls = bundled_measurer().measure(tracked.weights)
    asked = np.where(frame[:, None] % 600 < 20, controls + 3.0, np.nan)
    original = np.where(frame[:, None] % 3000 < 60, performance, tracked.weights)  # 72 edits
    turned = np.radians(20 * np.sin(frame[:, None] / FPS * np.array([1.0, 0.7, 0.4])))
    sound = Sound(np.abs(controls[:, 0]) + 1.0, DURATION_S)
    seen = Seen(
        tracked.weights,
        controls,
        FPS,
        tracked.lost,
        asked,
        controls,
        original_weights=original,
        rotations=turned,
        sound=sound,
    )
    flags = flags_of(seen)
    middle = len(performance) // 2
    return [
        Speed("flags_60min_s", percentile_ms(lambda _: flags_of(seen), 5, percentile=50) / 1e3, "s", 1.0),
        Speed(
            "flags_after_an_edit_60min_ms_p95",
            percentile_ms(lambda _: flags_after(flags, seen, (middle, middle + EDIT_FRAMES)), 20),
            "ms",
            100.0,
        ),
    ]
