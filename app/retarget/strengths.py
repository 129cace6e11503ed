"""How movement is matched: three strengths as sliders, each over a hundredfold around what was measured to be best."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QGridLayout, QSlider, QWidget

from app.widgets.section import quiet, slider
from app.widgets.text import Label
from engine.editing import Matching

STEPS = 50  # on either side of the middle; the lowest is none at all
DECADE = 50


@dataclass(frozen=True)
class Strength:
    """A field of `Matching`, what it is called, and what more of it does."""

    field: str
    title: str
    tip: str


STRENGTHS: tuple[Strength, ...] = (
    Strength(
        "alpha", "Likely poses", "More: poses that the target's shapes make likely. Less: closer to the movement."
    ),
    Strength("beta", "Positions", "More: long-held poses stay. Less: only movement counts, and poses drift to rest."),
    Strength("closure", "Closures", "More: lips and lids meet whenever the source's do. None: they are left alone."),
)


class StrengthSliders(QWidget):
    """A slider for each of `STRENGTHS`, all within `Matching`.

    Attributes
    ----------
    sliders : by field
    """

    changed = Signal(object)  # a Matching

    def __init__(self) -> None:
        super().__init__()
        self._matching = Matching()
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setVerticalSpacing(2)
        grid.setColumnStretch(0, 1)
        self.sliders: dict[str, QSlider] = {}
        self._values: dict[str, Label] = {}
        for row, strength in enumerate(STRENGTHS):
            value, bar = Label(), slider(-STEPS, STEPS)
            value.setAlignment(Qt.AlignmentFlag.AlignRight)
            bar.setAccessibleName(strength.title)
            bar.setToolTip(strength.tip)
            bar.valueChanged.connect(lambda _, field=strength.field: self._move(field))
            grid.addWidget(quiet(strength.title), 2 * row, 0)
            grid.addWidget(value, 2 * row, 1)
            grid.addWidget(bar, 2 * row + 1, 0, 1, 2)
            self.sliders[strength.field], self._values[strength.field] = bar, value
        self.show_matching(self._matching)

    def show_matching(self, matching: Matching) -> None:
        """Show strengths."""
        self._matching = matching
        for field, bar in self.sliders.items():
            value = getattr(matching, field)
            with QSignalBlocker(bar):
                bar.setValue(position(value, usual(field)))
            self._values[field].setText(f"{value:.3g}")

    def _move(self, field: str) -> None:
        value = strength_at(self.sliders[field].value(), usual(field))
        self._values[field].setText(f"{value:.3g}")
        self._matching = _with(self._matching, field, value)
        self.changed.emit(self._matching)


def _with(matching: Matching, field: str, value: float) -> Matching:
    numbers = {each.field: float(getattr(matching, each.field)) for each in STRENGTHS} | {field: value}
    return Matching(**numbers, bounds=matching.bounds)


def usual(field: str) -> float:
    """Return the strength in the middle of a slider."""
    return float(getattr(Matching(), field))


def strength_at(step: int, middle: float) -> float:
    """Return the strength of a slider's position; the leftmost is none."""
    return 0.0 if step <= -STEPS else float(middle * 10 ** (step / DECADE))


def position(value: float, middle: float) -> int:
    """Return the slider's position for a strength."""
    return -STEPS if value <= 0 else int(np.clip(round(DECADE * np.log10(value / middle)), -STEPS + 1, STEPS))
