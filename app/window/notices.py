"""The only place that shows errors: a banner that does not block."""

from __future__ import annotations

import logging

from PySide6.QtCore import QEvent, Qt, QTimer
from PySide6.QtGui import QEnterEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QToolButton

from app.theme import GRID
from app.widgets.text import Label

SHOWN_MS, READ_MS = 6_000, 60  # how long a notice stays at least, and longer by each of its characters
log = logging.getLogger(__name__)


class Notices(QFrame):
    """Shows a sentence and what to do about it, and hides itself after the time it takes to read.

    Escape and a button hide it at once. It stays while the pointer is on it or another window is active, and a danger to
    the work stays until it is over: `warn_until_solved`.
    """

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("banner")
        row = QHBoxLayout(self)
        row.setContentsMargins(2 * GRID, GRID - 2, GRID, GRID - 2)
        self.text = Label()
        self.text.setWordWrap(True)
        self.text.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        row.addWidget(self.text, 1)
        self.dismiss = QToolButton()
        self.dismiss.setText("✕")
        self.dismiss.setToolTip("Hide (Escape)")
        self.dismiss.setAccessibleName("Hide the notice")
        self.dismiss.clicked.connect(self.hide)
        row.addWidget(self.dismiss, 0, Qt.AlignmentFlag.AlignTop)
        self.fading = QTimer(self, singleShot=True)
        self.fading.timeout.connect(self._fade)
        self._stays = False
        self.hide()

    def add(self, sentence: str) -> None:
        """Put another sentence after what is shown."""
        self._show(self.text.text(), sentence, stays=self._stays)

    def withdraw(self, sentence: str) -> None:
        """Hide a sentence that is no longer true, if it is still shown."""
        if self.text.text().startswith(sentence):
            self.hide()

    def warn(self, sentence: str, advice: str = "") -> None:
        """Show a sentence and an advice for as long as it takes to read them."""
        log.warning("%s %s", sentence, advice)
        self._show(sentence, advice, stays=False)

    def warn_until_solved(self, sentence: str, advice: str = "") -> None:
        """Show a sentence and an advice until they are hidden, withdrawn or replaced."""
        log.warning("%s %s", sentence, advice)
        self._show(sentence, advice, stays=True)

    def inform(self, sentence: str, advice: str = "") -> None:
        """Show what is no error, such as the name of a written file."""
        self._show(sentence, advice, stays=False)

    def hide_shown(self) -> bool:
        """Hide the notice; returns whether there was any."""
        shown = self.isVisible()
        self.hide()
        return shown

    def enterEvent(self, event: QEnterEvent) -> None:
        """Stay for as long as the pointer is here."""
        super().enterEvent(event)
        self.fading.stop()

    def leaveEvent(self, event: QEvent) -> None:
        """Hide a while after the pointer left."""
        super().leaveEvent(event)
        self._begin_to_fade()

    def _show(self, sentence: str, advice: str, *, stays: bool) -> None:
        self.text.setText(f"{sentence} {advice}".strip())
        self._stays = stays
        self.show()
        self.fading.stop()
        if not self.underMouse():
            self._begin_to_fade()

    def _begin_to_fade(self) -> None:
        if not self._stays and not self.isHidden():
            self.fading.start(SHOWN_MS + READ_MS * len(self.text.text()))

    def _fade(self) -> None:
        """Hide, unless the window is not active: then wait on."""
        if self.window().isActiveWindow():
            self.hide()
        else:
            self._begin_to_fade()
