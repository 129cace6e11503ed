"""The pieces that the panel at the right is made of, and the small widgets they share."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QAbstractSpinBox, QHBoxLayout, QLayout, QSlider, QSpinBox, QVBoxLayout, QWidget

from app.session import Session
from app.theme import GRID
from app.widgets.text import Label
from engine.words import plural

NUMBER_PX = 96  # of every box with a number


class Section(QWidget):
    """A titled group of settings.

    Attributes
    ----------
    tools : the tools it is shown with; empty for always
    away : the tools it makes room for
    needed : whether it has anything to show
    """

    tools: frozenset[str] = frozenset()
    away: frozenset[str] = frozenset()
    needed = True

    def __init__(self, session: Session, title: str) -> None:
        super().__init__()
        self.session = session
        self.column = QVBoxLayout(self)
        self.column.setContentsMargins(0, 0, 0, GRID)
        self.column.setSpacing(GRID - 2)
        self.title = heading(title)
        self.column.addWidget(self.title)

    def row(self, title: str, widget: QWidget) -> None:
        """Add a widget with its name at its left."""
        row = QHBoxLayout()
        label = quiet(title)
        label.setBuddy(widget)
        row.addWidget(label, 1)
        row.addWidget(widget)
        self.column.addLayout(row)
        widget.setAccessibleName(title)
        if isinstance(widget, QAbstractSpinBox):
            widget.setFixedWidth(NUMBER_PX)

    def side_by_side(self, *widgets: QWidget) -> None:
        """Add widgets in one row."""
        row = QHBoxLayout()
        row.setSpacing(GRID)
        for widget in widgets:
            row.addWidget(widget)
        self.column.addLayout(row)


def empty(layout: QLayout) -> None:
    """Take everything out of a layout; it is gone from the screen at once."""
    while (item := layout.takeAt(0)) is not None:
        if (old := item.widget()) is not None:
            old.hide()
            old.deleteLater()


class CountBox(QSpinBox):
    """A box with a number and the name of what it counts, one or many.

    Parameters
    ----------
    noun : what one of it is called
    lowest, highest : the range
    """

    def __init__(self, noun: str, *, lowest: int, highest: int) -> None:
        super().__init__(minimum=lowest, maximum=highest)
        self._noun = noun
        self.valueChanged.connect(self._name)
        self._name(self.value())

    def setValue(self, value: int) -> None:
        """Show a number; what it counts is named even while signals are blocked."""
        super().setValue(value)
        self._name(self.value())

    def _name(self, number: int) -> None:
        self.setSuffix(f" {plural(number, self._noun)}")


def heading(text: str) -> Label:
    """Return a title."""
    label = Label(text)
    label.setProperty("heading", True)
    return label


def quiet(text: str) -> Label:
    """Return a label in the quiet colour that wraps."""
    label = Label(text)
    label.setProperty("quiet", True)
    label.setWordWrap(True)
    return label


def slider(lowest: int, highest: int) -> QSlider:
    """Return a horizontal slider."""
    bar = QSlider(Qt.Orientation.Horizontal)
    bar.setRange(lowest, highest)
    return bar
