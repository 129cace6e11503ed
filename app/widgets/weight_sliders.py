"""A face's weights as sliders: those that match a search, or else those most active."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QGridLayout, QLineEdit, QSlider, QVBoxLayout, QWidget

from app.widgets.section import empty, quiet, slider
from app.widgets.text import Label
from engine.take import SHAPE_INDEX, SHAPES, Array

STEPS = 200
SHOWN = 12


class WeightSliders(QWidget):
    """A search box and a slider for each of a few weights.

    Attributes
    ----------
    search : what is typed narrows the list
    sliders : by shape name
    """

    moved = Signal(str, float)
    searched = Signal()

    def __init__(self) -> None:
        super().__init__()
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        self.search = QLineEdit()
        self.search.setPlaceholderText("Search shapes…")
        self.search.setClearButtonEnabled(True)
        self.search.textChanged.connect(lambda _: self.searched.emit())
        column.addWidget(self.search)
        self._grid = QGridLayout()
        self._grid.setContentsMargins(0, 0, 0, 0)
        self._grid.setVerticalSpacing(2)
        self._grid.setColumnStretch(0, 1)
        column.addLayout(self._grid)
        self.sliders: dict[str, QSlider] = {}
        self._values: dict[str, Label] = {}

    def show_face(self, weights: Array, activity: Array, moved: Mapping[str, float]) -> None:
        """List the weights of a face, (52,), the moved ones first, then by activity, (52,)."""
        listed = self._listed(activity, list(moved))
        if listed != list(self.sliders):
            self._lay_out(listed)
        for name in listed:
            value = moved.get(name, float(weights[SHAPE_INDEX[name]]))
            self._values[name].setText(f"{value:.2f}")
            with QSignalBlocker(self.sliders[name]):
                self.sliders[name].setValue(round(value * STEPS))

    def _listed(self, activity: Array, moved: list[str]) -> list[str]:
        wanted = self.search.text().strip().lower()
        if wanted:
            return [name for name in SHAPES if wanted in name.lower()][:SHOWN]
        return moved + [SHAPES[i] for i in np.argsort(-activity) if SHAPES[i] not in moved][: SHOWN - len(moved)]

    def _lay_out(self, names: list[str]) -> None:
        empty(self._grid)
        self.sliders, self._values = {}, {}
        for row, name in enumerate(names):
            label, number, bar = quiet(name), Label(), slider(0, STEPS)
            label.setWordWrap(False)
            number.setAlignment(Qt.AlignmentFlag.AlignRight)
            bar.setAccessibleName(name)
            bar.valueChanged.connect(lambda at, name=name: self._move(name, at / STEPS))
            self._grid.addWidget(label, 2 * row, 0)
            self._grid.addWidget(number, 2 * row, 1)
            self._grid.addWidget(bar, 2 * row + 1, 0, 1, 2)
            self.sliders[name], self._values[name] = bar, number

    def _move(self, name: str, value: float) -> None:
        self._values[name].setText(f"{value:.2f}")
        self.moved.emit(name, value)
