"""The panel at the right: the sections that belong to the tool at work."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QAbstractSpinBox, QFrame, QLineEdit, QScrollArea, QVBoxLayout, QWidget

from app.session import Change, Session
from app.theme import GRID
from app.widgets.section import Section

WIDTH_PX = 248


class Inspector(QFrame):
    """Shows each section with the tools it serves.

    Parameters
    ----------
    session : whose tool is at work
    sections : from top to bottom
    """

    def __init__(self, session: Session, sections: Sequence[Section]) -> None:
        super().__init__()
        self.setProperty("panel", True)
        self.setFixedWidth(WIDTH_PX)
        self._session, self._sections = session, tuple(sections)
        inner = QWidget()
        column = QVBoxLayout(inner)
        column.setContentsMargins(2 * GRID, 2 * GRID - 4, 2 * GRID - 2, GRID)
        column.setSpacing(GRID)
        for section in sections:
            column.addWidget(section)
        for box in inner.findChildren(QAbstractSpinBox):
            for entry in box.findChildren(QLineEdit):  # whose text the style sheet leaves at the edge
                entry.setTextMargins(GRID // 2, 0, 0, 0)
        column.addStretch(1)
        area = QScrollArea()
        area.setWidgetResizable(True)
        area.setFrameShape(QFrame.Shape.NoFrame)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setWidget(inner)
        outer = QVBoxLayout(self)
        outer.setContentsMargins(1, 1, 1, 1)
        outer.addWidget(area)
        session.changed.connect(self._on_change)
        self._on_change(Change.TOOL)

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.TOOL):
            for section in self._sections:
                tool = self._session.view.tool
                wanted = tool not in section.away and (not section.tools or tool in section.tools)
                section.setVisible(section.needed and wanted)
