"""Sound and video that a project names and that are not there: said in a banner, which can find them."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QPushButton, QVBoxLayout, QWidget

from app.theme import GRID
from app.widgets.section import empty
from app.widgets.text import Label, caption
from engine.project import Found, name_of


class MissingMedia(QFrame):
    """One row for each file; it blocks nothing and goes away when the file is found, detached or not wanted now."""

    locate = Signal(str)  # kind
    accept = Signal(str)
    detach = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("banner")
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(2 * GRID, GRID - 2, GRID, GRID - 2)
        self._column.setSpacing(GRID - 2)
        self.hide()

    def show_missing(self, missing: dict[str, Found]) -> None:
        """Show a row for each file that is missing."""
        empty(self._column)
        for kind, found in missing.items():
            self._column.addWidget(self._row(kind, found))
        self.setVisible(bool(missing))

    def _row(self, kind: str, found: Found) -> QWidget:
        widget = QWidget()
        row = QHBoxLayout(widget)
        row.setContentsMargins(0, 0, 0, 0)
        changed = found.changed is not None
        advice = " Its content has changed." if changed else " It was moved, renamed or deleted."
        text = Label(found.sentence + advice)
        text.setWordWrap(True)
        row.addWidget(text, 1)
        buttons = [(f"Locate {name_of(found.media)}…", self.locate.emit), ("Detach it", self.detach.emit)]
        if changed:
            buttons.insert(0, ("Use it all the same", self.accept.emit))
        for number, (title, do) in enumerate(buttons):
            button = QPushButton(caption(title))
            button.setProperty("primary", number == 0)
            button.clicked.connect(partial(_called, do, kind))
            row.addWidget(button)
        later = QPushButton("Not now")
        later.clicked.connect(partial(self._hide_row, widget))
        row.addWidget(later)
        return widget

    def _hide_row(self, row: QWidget, *_: bool) -> None:
        row.hide()
        rows = [item.widget() for index in range(self._column.count()) if (item := self._column.itemAt(index))]
        self.setVisible(any(each is not None and not each.isHidden() for each in rows))


def _called(do, kind: str, *_: bool) -> None:  # type: ignore[no-untyped-def]
    do(kind)
