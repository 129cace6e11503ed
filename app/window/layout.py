"""Where the parts of the window stand."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFrame, QHBoxLayout, QScrollArea, QSplitter, QVBoxLayout, QWidget

from app.curves.places import GUTTER_PX
from app.theme import GRID
from app.timeline.panel import SCROLL_PX
from app.timeline.scroll import TimeScroll
from app.window.parts import WindowParts

SHARES_PX = (470, 710)  # of preview and curves, in a window as it was designed


def lay_out(window: WindowParts) -> None:
    """Lay out toolbar, notices, then preview, curves and inspector, then the status bar, from top to bottom."""
    window.preview.add_beneath(window.reference)
    middle = QHBoxLayout()
    middle.setSpacing(GRID)
    middle.addWidget(_preview_and_curves(window), 1)
    middle.addWidget(window.inspector)
    central = QWidget()
    central.setObjectName("central")
    column = QVBoxLayout(central)
    column.setContentsMargins(GRID, 0, GRID, GRID)
    column.setSpacing(GRID)
    for part in (window.menus.toolbar(), window.notices, window.missing, window.importing):
        column.addWidget(part)
    column.addLayout(middle, 1)
    column.addWidget(window.status)
    window.setCentralWidget(central)


def _preview_and_curves(window: WindowParts) -> QSplitter:
    split = QSplitter(Qt.Orientation.Horizontal)
    split.setHandleWidth(GRID)
    split.setChildrenCollapsible(False)
    split.addWidget(window.preview)
    split.addWidget(_lanes(window))
    split.setStretchFactor(0, 2)
    split.setStretchFactor(1, 3)
    split.setSizes(list(SHARES_PX))
    return split


def _lanes(window: WindowParts) -> QFrame:
    """Return the timeline over the curves, which scroll, over the bar that scrolls time."""
    lanes = QFrame()
    lanes.setProperty("panel", True)
    stack = QVBoxLayout(lanes)
    stack.setContentsMargins(1, 6, 1, 4)
    stack.setSpacing(2)
    stack.addWidget(window.timeline)
    area = QScrollArea()
    area.setWidgetResizable(True)
    area.setFrameShape(QFrame.Shape.NoFrame)
    area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
    area.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOn)
    area.setWidget(window.curves)
    stack.addWidget(area, 1)
    scroll = QHBoxLayout()
    scroll.setContentsMargins(GUTTER_PX, 0, GRID + SCROLL_PX, 0)
    scroll.addWidget(TimeScroll(window.session))
    stack.addLayout(scroll)
    return lanes
