"""Shows a newcomer as many whole hints in the toolbar as there is room for."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QSizePolicy

from app.theme import GRID
from app.widgets.text import Label

BETWEEN = " · "


class Hints(Label):
    """Takes whatever room the toolbar has left, told or not, so that no button ever moves."""

    def __init__(self) -> None:
        super().__init__()
        self._hints: tuple[str, ...] = ()
        self.setProperty("quiet", True)
        self.setAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
        self.setIndent(GRID)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)

    def show_all(self, hints: Sequence[str]) -> None:
        """Show hints, the one that matters most first; none for nothing."""
        self._hints = tuple(hints)
        self.setToolTip("\n".join(hints))
        self._fit()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Show more or fewer of them."""
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        self.ensurePolished()  # the style sheet's font is not there before
        shown = [BETWEEN.join(self._hints[:count]) for count in range(len(self._hints), 0, -1)]
        room = self.width() - GRID
        self.setText(next((text for text in shown if self.fontMetrics().horizontalAdvance(text) <= room), ""))
