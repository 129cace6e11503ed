"""How far something is that goes on beside the window, and a button that stops it."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QHBoxLayout, QProgressBar, QSizePolicy, QToolButton, QWidget

from app.theme import GRID

SHOWN_AFTER_MS = 150  # what is done sooner needs no bar
BAR_PX, BAR_HEIGHT_PX, STEPS = 96, 8, 1000


class Progress(QWidget):
    """A bar and a button, shown only while something goes on that takes a while.

    Parameters
    ----------
    what : what the button does, in the user's words
    stop : called by the button
    """

    def __init__(self, what: str, stop: Callable[[], None]) -> None:
        super().__init__()
        self.bar = QProgressBar(minimum=0, maximum=STEPS, textVisible=False)
        self.bar.setFixedSize(BAR_PX, BAR_HEIGHT_PX)
        self.button = QToolButton()
        self.button.setText("✕")
        self.button.setFixedWidth(2 * BAR_HEIGHT_PX)
        for part in (
            self,
            self.button,
        ):  # as high as the line it is in: coming and going must not move the whole window
            part.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Ignored)
        self.button.setStyleSheet("padding: 0;")
        self.button.setToolTip(what)
        self.button.setAccessibleName(what)
        self.button.clicked.connect(stop)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(GRID // 2)
        row.addWidget(self.bar)
        row.addWidget(self.button)
        self._soon = QTimer(self, singleShot=True, interval=SHOWN_AFTER_MS)
        self._soon.timeout.connect(self.show)
        self.hide()

    def follow(self, under_way: bool) -> None:
        """Show the bar, empty, for what is under way if it does not end soon; put it away when it has ended."""
        if not under_way:
            self._soon.stop()
            self.hide()
            return
        self.bar.setValue(0)
        if not self.isVisible():
            self._soon.start()

    def advance(self, share: float) -> None:
        """Show what share is done, 0 to 1."""
        self.bar.setValue(round(STEPS * share))
