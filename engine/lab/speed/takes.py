"""Reading long takes, and moving a face."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from engine.character import bundled
from engine.formats import read_take, write_take
from engine.lab.speed.timing import Speed, percentile_ms, performance_of


def measure() -> list[Speed]:
    """Measure a 60 min take at 60 fps from file to memory, and one frame of weights to vertices."""
    long = performance_of(3600.0, 60.0)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "long.csv"
        write_take(long, path)
        began = time.perf_counter()
        read_take(path)
        spent = time.perf_counter() - began
    head = bundled()
    vertices = percentile_ms(lambda index: head.vertices(long.weights[index]), 300)
    return [Speed("load_60min_s", spent, "s", 4.0), Speed("vertices_ms_p95", vertices, "ms", 1.0)]
