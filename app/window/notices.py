"""The only place that shows errors: a banner that does not block."""

from __future__ import annotations

import logging

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFrame, QHBoxLayout, QPushButton

from app.theme import GRID
from app.widgets.text import Label

log = logging.getLogger(__name__)


class Notices(QFrame):
    """One sentence, what to do about it, and a button to put it away."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("banner")
        row = QHBoxLayout(self)
        row.setContentsMargins(2 * GRID, GRID - 2, GRID, GRID - 2)
        self.text = Label()
        self.text.setWordWrap(True)
        self.text.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        row.addWidget(self.text, 1)
        self.dismiss = QPushButton("OK")
        self.dismiss.clicked.connect(self.hide)
        row.addWidget(self.dismiss)
        self.hide()

    def add(self, sentence: str) -> None:
        """Put another sentence after what is shown."""
        self.tell(self.text.text(), sentence)

    def withdraw(self, sentence: str) -> None:
        """Put a sentence away that is true no more, if it is still shown."""
        if self.text.text().startswith(sentence):
            self.hide()

    def tell(self, sentence: str, advice: str = "") -> None:
        """Show a sentence and an advice until it is put away or replaced."""
        log.warning("%s %s", sentence, advice)
        self.text.setText(f"{sentence} {advice}".strip())
        self.show()
