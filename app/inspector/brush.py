"""The Drag tool's brush."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker
from PySide6.QtWidgets import QDoubleSpinBox, QMenu, QPushButton, QSpinBox

from app.session import RADII_S, Change, Session
from app.session.curve_table import CURVES, FIRST_WEIGHT
from app.widgets.section import Section, slider
from engine.controls import CONTROLS

STEP_S, SLIDER_STEPS = 0.02, 150  # of the slider: to three seconds, further by typing


class BrushSection(Section):
    """Radius, strength and believability, by slider and by typing, and which further curves are shown."""

    tools = frozenset({"drag", "draw", "scale"})

    def __init__(self, session: Session) -> None:
        super().__init__(session, "Brush")
        self.radius = QDoubleSpinBox(minimum=RADII_S[0], maximum=RADII_S[1], suffix=" s", singleStep=0.05)
        self.radius.setToolTip("How far on either side frames follow. Turn the wheel while dragging to change it.")
        self._radius_slider = slider(1, SLIDER_STEPS)
        self.row("Radius", self.radius)
        self.column.addWidget(self._radius_slider)
        self.strength = QSpinBox(minimum=0, maximum=100, suffix=" %")
        self._strength_slider = slider(0, 100)
        self.row("Strength", self.strength)
        self.column.addWidget(self._strength_slider)
        self.believability = QSpinBox(minimum=0, maximum=100, suffix=" %")
        self.believability.setToolTip(
            "100 %: the face does only what this take or the recordings did.  0 %: it goes wherever you drag it."
        )
        self._believability_slider = slider(0, 100)
        self.row("Believability", self.believability)
        self.column.addWidget(self._believability_slider)
        self.more = QPushButton("+ curve")
        self.more.setToolTip("Show more curves to drag: brows, gaze, the jaw sideways, how high the corners are.")
        self._menu = QMenu(self.more)
        self.more.setMenu(self._menu)
        for column in range(len(CONTROLS), FIRST_WEIGHT):
            entry = self._menu.addAction(CURVES[column].title[0].upper() + CURVES[column].title[1:])
            entry.setCheckable(True)
            entry.setData(column)
            entry.toggled.connect(lambda on, column=column: self.session.view.add_lane(column, shown=on))
        self.column.addWidget(self.more)
        self.radius.valueChanged.connect(self._set_radius)
        self._radius_slider.valueChanged.connect(lambda steps: self._set_radius(steps * STEP_S))
        for widget in (self.strength, self._strength_slider):
            widget.valueChanged.connect(self._set_strength)
        for widget in (self.believability, self._believability_slider):
            widget.valueChanged.connect(self._set_believability)
        session.changed.connect(self._on_change)
        self._show()

    def _set_radius(self, seconds: float) -> None:
        self.session.view.set_brush(radius_s=seconds)

    def _set_strength(self, percent: int) -> None:
        self.session.view.set_brush(strength=percent / 100)

    def _set_believability(self, percent: int) -> None:
        self.session.view.set_brush(believability=percent / 100)

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.TOOL | Change.LANES):
            self._show()

    def _show(self) -> None:
        radius_s, percent = self.session.view.radius_s, round(100 * self.session.view.strength)
        with QSignalBlocker(self.radius):
            self.radius.setValue(radius_s)
        for widget, value in (
            (self._radius_slider, round(radius_s / STEP_S)),
            (self.strength, percent),
            (self._strength_slider, percent),
            (self.believability, round(100 * self.session.view.believability)),
            (self._believability_slider, round(100 * self.session.view.believability)),
        ):
            with QSignalBlocker(widget):
                widget.setValue(value)
        for entry in self._menu.actions():
            with QSignalBlocker(entry):
                entry.setChecked(entry.data() in self.session.view.added)
