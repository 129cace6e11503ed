"""The active curve's value at the playhead, to be typed."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QDoubleSpinBox, QPushButton

from app.session import Change, Session
from app.session.curve_table import CURVES
from app.widgets.section import Section
from engine.controls import ALL_CONTROLS


def closes(lane: int) -> bool:
    """Return whether a curve is a distance that can be closed: the lips', or an eye's."""
    curve = CURVES[lane]
    control = ALL_CONTROLS[curve.column] if not curve.is_weight else None
    return control is not None and (control.name == "lips_vertical" or control.area == "eyelids")


class ValueSection(Section):
    """What can be dragged can be typed; lips and eyes can be closed."""

    tools = frozenset({"drag", "draw", "scale"})
    typed = Signal(float)
    close_here = Signal()

    def __init__(self, session: Session) -> None:
        super().__init__(session, "")
        self.value = QDoubleSpinBox(decimals=1, minimum=-200.0, maximum=200.0)
        self.value.setKeyboardTracking(False)
        self.value.setToolTip("Type what it should be at the playhead; the brush's radius eases it in and out.")
        self.row("At the playhead", self.value)
        self.value.editingFinished.connect(self._typed)
        self.close_button = QPushButton("Close here")
        self.close_button.setToolTip(
            "Bring the lips together as far as the brush reaches, or the eyelids for a blink; the selection stays closed."
        )
        self.close_button.clicked.connect(self.close_here)
        self.column.addWidget(self.close_button)
        session.changed.connect(self._on_change)
        self._show()

    def _typed(self) -> None:
        shown = round(
            self.session.document.value(self.session.view.lane, self.session.view.playhead), self.value.decimals()
        )
        if abs(self.value.value() - shown) > 0.4 * 10.0 ** -self.value.decimals():
            self.typed.emit(self.value.value())

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.LANE | Change.PLAYHEAD | Change.CURVES | Change.DRAFT):
            self._show()

    def _show(self) -> None:
        session, curve = self.session, CURVES[self.session.view.lane]
        self.title.setText(curve.title if curve.is_weight else curve.title[0].upper() + curve.title[1:])
        self.close_button.setVisible(closes(session.view.lane))
        self.value.setDecimals(2 if curve.is_weight else 1)
        self.value.setMinimum(max(-200.0, curve.lowest))
        self.value.setSingleStep(0.05 if curve.is_weight else 0.5)
        self.value.setSuffix("" if curve.is_weight else f" {curve.unit}")
        if not self.value.hasFocus():
            with QSignalBlocker(self.value):
                self.value.setValue(session.document.value(session.view.lane, session.view.playhead))
