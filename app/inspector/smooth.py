"""Butterworth smoothing with a live preview."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QDoubleSpinBox, QPushButton

from app.session import Change, Session
from app.widgets.section import Section, slider

FIRST_CUTOFF_HZ = 6.0


class SmoothSection(Section):
    """A cutoff that previews while it moves, and whether to keep what it does."""

    tools = frozenset({"scale", "clean"})
    moved = Signal(float)  # Hz, while it moves
    kept = Signal()
    dropped = Signal()

    def __init__(self, session: Session) -> None:
        super().__init__(session, "Smooth")
        self.cutoff = QDoubleSpinBox(decimals=1, suffix=" Hz")
        self.cutoff.setToolTip("Butterworth, zero phase: peaks stay where they are. The selection, or the whole take.")
        self._slider = slider(5, 140)
        self.row("Cutoff", self.cutoff)
        self.column.addWidget(self._slider)
        self.keep_button, self.drop_button = QPushButton("Apply"), QPushButton("Discard")
        self.side_by_side(self.keep_button, self.drop_button)
        self._slider.valueChanged.connect(self._slide)
        self.cutoff.valueChanged.connect(self.moved)
        self.keep_button.clicked.connect(self.kept)
        self.drop_button.clicked.connect(self.dropped)
        session.changed.connect(self._on_change)
        self._show()

    def _slide(self, tenths: int) -> None:
        self.cutoff.setValue(tenths / 10)

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.READING):
            self._show()

    def _show(self) -> None:
        highest = 0.45 * self.session.document.take.fps
        with QSignalBlocker(self.cutoff), QSignalBlocker(self._slider):
            self.cutoff.setRange(0.5, highest)
            self._slider.setRange(5, int(10 * highest))
            self.cutoff.setValue(min(FIRST_CUTOFF_HZ, highest))
            self._slider.setValue(int(10 * self.cutoff.value()))
