"""How fast the methods are, each against its goal, measured in one run on the machine at hand."""

from __future__ import annotations

from collections.abc import Callable

from engine.lab.speed import clean, drag, fill, manifold, quality, spacetime, takes
from engine.lab.speed.timing import Speed

METHODS: dict[str, Callable[[], list[Speed]]] = {
    "takes": takes.measure,
    "drag": drag.measure,
    "spacetime": spacetime.measure,
    "clean": clean.measure,
    "manifold": manifold.measure,
    "fill": fill.measure,
    "quality": quality.measure,
}
