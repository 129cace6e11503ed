"""The scroll bar beneath the lanes."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtWidgets import QScrollBar

from app.session import Change, Session


class TimeScroll(QScrollBar):
    """Where in the take the view is, in frames."""

    def __init__(self, session: Session) -> None:
        super().__init__(Qt.Orientation.Horizontal)
        self._session = session
        self.valueChanged.connect(self._scrolled)
        session.changed.connect(self._on_change)
        self._on_change(Change.VIEW)

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.VIEW):
            first, last = self._session.view.range
            with QSignalBlocker(self):
                self.setRange(0, max(0, len(self._session.document.take) - 1 - int(last - first)))
                self.setPageStep(max(1, int(last - first)))
                self.setSingleStep(max(1, int((last - first) / 20)))
                self.setValue(int(first))

    def _scrolled(self, value: int) -> None:
        first, last = self._session.view.range
        self._session.view.set_range(value, value + last - first)
