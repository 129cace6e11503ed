"""A capture: tracked points over time, whatever file they came from."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from engine.errors import EditError
from engine.formats.base.budget import BUDGET
from engine.take import Array
from engine.words import counted, plural

CAPTURE_BUDGET = replace(BUDGET, values=40_000_000)  # 41 markers at 60 frames per second for an hour and a half

FARTHEST_MM = 1e8
SLOWEST_FPS, FASTEST_FPS = 0.01, 10_000.0
TO_MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4}
_SPELT = {"milli": "mm", "centi": "cm", "met": "m", "inch": "in"}  # how the long name of a unit begins


@dataclass(frozen=True, eq=False)
class Markers:
    """A capture: where each marker is in each frame.

    Attributes
    ----------
    positions : (frames, n, 3) float64 mm; NaN where a marker was not seen
    names : of the markers, each once
    fps : frames per second
    name : what to call the capture on screen
    notices : sentences about the import that the user should see
    """

    positions: Array
    names: tuple[str, ...]
    fps: float
    name: str = "untitled"
    notices: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.positions.ndim != 3 or self.positions.shape[1:] != (len(self.names), 3) or not len(self.positions):
            raise EditError("A capture needs at least one frame and three coordinates for each marker.")
        twice = [name for name, count in Counter(self.names).items() if count > 1]
        if twice:
            raise EditError(f"The marker {twice[0][:40]!r} is there twice.", "Rename or remove one of the two.")
        if (np.abs(self.positions) > FARTHEST_MM).any():
            raise EditError("A marker is further away than a face can be.", "Check the unit of the file.")
        if not SLOWEST_FPS <= self.fps <= FASTEST_FPS:
            raise EditError(
                f"A capture needs a frame rate above zero and below {FASTEST_FPS:,.0f}; this one has {self.fps:g}.",
                "Export it again with its rate.",
            )

    def __len__(self) -> int:
        return len(self.positions)


def unit_named(text: str) -> str | None:
    """Return the unit, a key of `TO_MM`, that a file names, short or in full; None for another."""
    name = text.strip().lower()
    if name in TO_MM:
        return name
    return next((unit for start, unit in _SPELT.items() if name.startswith(start)), None)


def each_once(names: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return names with a number behind those that were there before, and a sentence where there were any.

    A marker without a name is called by its place, such as marker 7.
    """
    taken, found = {name.strip() for name in names}, []
    seen: set[str] = set()
    doubled = []
    for place, given in enumerate(names, 1):
        name = given.strip() or f"marker {place}"
        if name in seen:
            doubled.append(name)
            number = 2
            while f"{name} {number}" in seen or f"{name} {number}" in taken:
                number += 1
            name = f"{name} {number}"
        seen.add(name)
        found.append(name)
    count, named = len(doubled), plural(len(doubled), "has", "have")
    sentence = (
        f"{counted(count, 'marker')} {named} a name that another has too, and got a number: {doubled[0][:40]}."
        if doubled
        else ""
    )
    return tuple(found), (sentence,) if sentence else ()


def unit_by_size(positions: Array) -> tuple[str, str]:
    """Return the unit in which markers, (frames, n, 3), are as large as a face, and a sentence that says so."""
    low, high = np.nanmin(positions, axis=1), np.nanmax(positions, axis=1)
    extent = float(np.nanmedian((high - low).max(axis=1)))
    unit = "m" if extent < 1.5 else "cm" if extent < 45 else "mm"
    return unit, f"Positions are taken as {unit}: the markers span {extent:.3g} {unit}."
