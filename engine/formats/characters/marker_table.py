"""Which markers of a capture are which landmarks; apart from how they are found, so that a table loads no solver."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from engine.errors import EditError
from engine.spacetime.layout import MARKERS
from engine.take import Array


@dataclass(frozen=True)
class MarkerMatch:
    """One marker of a capture.

    Attributes
    ----------
    marker : its name in the file
    landmark : the standard marker that it is; empty for one that lies elsewhere
    away_mm : how far it is from it on the bundled head; 0 where the name says it
    how : by name, by place, by hand, or left out
    """

    marker: str
    landmark: str
    away_mm: float
    how: str


@dataclass(frozen=True, eq=False)
class MarkerTable:
    """All markers of a capture.

    Attributes
    ----------
    rows : in the file's order
    turn : (3, 3) rotation from the capture's axes to ours, acting on rows
    """

    rows: tuple[MarkerMatch, ...] = ()
    turn: Array = field(default_factory=lambda: np.eye(3))

    @property
    def landmarks(self) -> dict[str, str]:
        """The landmark of each marker that is one, by the marker's name."""
        return {row.marker: row.landmark for row in self.rows if row.landmark}

    @property
    def left_out(self) -> frozenset[str]:
        """The markers that a person left out."""
        return frozenset(row.marker for row in self.rows if row.how == "left out")

    def corrected(self, changes: Mapping[str, str]) -> MarkerTable:
        """Return the table with landmarks by hand; an empty one leaves the marker out. Raises `EditError` for what is not there."""
        known = {row.marker for row in self.rows}
        for marker, landmark in changes.items():
            if marker not in known:
                raise EditError(f"The capture has no marker called {marker[:40]!r}.")
            if landmark and landmark not in MARKERS:
                raise EditError(
                    f"There is no marker place called {landmark[:40]!r}.", f"There are: {', '.join(MARKERS)}."
                )
        rows = [
            replace(row, landmark=changes[row.marker], away_mm=0.0, how="by hand" if changes[row.marker] else "left out")
            if row.marker in changes
            else replace(row, landmark="", how="by place") if row.landmark in changes.values() else row
            for row in self.rows
        ]  # fmt: skip
        return replace(self, rows=tuple(rows))
