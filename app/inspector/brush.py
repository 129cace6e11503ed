"""The Drag tool's brush."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker
from PySide6.QtWidgets import QCheckBox, QDoubleSpinBox, QSpinBox

from app.session import RADII_S, Change, Session
from app.widgets.section import Section, slider

STEP_S, SLIDER_STEPS = 0.02, 150  # of the slider: to three seconds, further by typing


class BrushSection(Section):
    """Radius and strength, by slider and by typing, whether the curve is hit exactly and the rest follows."""

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
        self.exact = QCheckBox("Hit the curve exactly")
        self.exact.setToolTip("Plausible, the default, keeps the face believable; exact goes where you drag it.")
        self.column.addWidget(self.exact)
        self.follow = QCheckBox("Let the rest follow")
        self.follow.setToolTip(
            "Curves that you never touched go along with the one you pull; without it, they hold it back where they were."
        )
        self.column.addWidget(self.follow)
        self.radius.valueChanged.connect(self._set_radius)
        self._radius_slider.valueChanged.connect(lambda steps: self._set_radius(steps * STEP_S))
        self.strength.valueChanged.connect(self._set_strength)
        self._strength_slider.valueChanged.connect(self._set_strength)
        self.exact.toggled.connect(self._set_exact)
        self.follow.toggled.connect(self._set_follow)
        session.changed.connect(self._on_change)
        self._show()

    def _set_radius(self, seconds: float) -> None:
        self.session.set_brush(radius_s=seconds)

    def _set_strength(self, percent: int) -> None:
        self.session.set_brush(strength=percent / 100)

    def _set_exact(self, on: bool) -> None:
        self.session.set_brush(exact=on)

    def _set_follow(self, on: bool) -> None:
        self.session.set_brush(follow=on)

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.TOOL):
            self._show()

    def _show(self) -> None:
        radius_s, percent = self.session.radius_s, round(100 * self.session.strength)
        with QSignalBlocker(self.radius):
            self.radius.setValue(radius_s)
        for widget, value in (
            (self._radius_slider, round(radius_s / STEP_S)),
            (self.strength, percent),
            (self._strength_slider, percent),
        ):
            with QSignalBlocker(widget):
                widget.setValue(value)
        for box, on in ((self.exact, self.session.exact), (self.follow, self.session.follow)):
            with QSignalBlocker(box):
                box.setChecked(on)
