"""A page to read beside the work: the list of keys, and what this is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QDialog, QLabel, QPushButton, QVBoxLayout, QWidget

from app.theme import GRID

COLUMNS = 3


class Page(QDialog):
    """Rich text in a window of its own, which goes with Escape or Close.

    Parameters
    ----------
    title, text : what it is called and what it says
    parent : the window
    """

    def __init__(self, title: str, text: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.setWindowTitle(title)
        self.setModal(False)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.text = QLabel()  # the only one with markup, whose text is the program's own: `in_columns` and `in_lines`
        self.text.setTextFormat(Qt.TextFormat.RichText)
        self.text.setText(text)
        self.text.setTextInteractionFlags(
            Qt.TextInteractionFlag.TextSelectableByMouse
        )  # versions and paths are for copying
        column = QVBoxLayout(self)
        column.setContentsMargins(3 * GRID, 2 * GRID, 3 * GRID, 2 * GRID)
        column.setSpacing(2 * GRID)
        column.addWidget(self.text)
        column.addWidget(closing(self), alignment=Qt.AlignmentFlag.AlignRight)


def closing(dialog: QDialog) -> QPushButton:
    """Return the button that closes a dialog."""
    button = QPushButton("Close")
    button.setProperty("primary", True)
    button.clicked.connect(dialog.close)
    return button


def in_lines(heading: str, lines: Sequence[str]) -> str:
    """Return a heading and lines of plain text as rich text."""
    return "<br>".join([f"<b>{escape(heading)}</b>", *map(escape, lines)])


def in_columns(groups: Mapping[str, Sequence[tuple[str, str]]]) -> str:
    """Return named groups of pairs as rich text, in columns of about one height; a group is not torn apart."""
    places, heights = dict.fromkeys(groups, 0), [0] * COLUMNS
    for name in sorted(groups, key=lambda name: -len(groups[name])):  # the longest first: the rest fills what is left
        places[name] = heights.index(min(heights))
        heights[places[name]] += 2 + len(groups[name])
    columns = ["".join(_table(name, groups[name]) for name in groups if places[name] == at) for at in range(COLUMNS)]
    cells = "".join(f"<td style='padding-right: {3 * GRID}px'>{column}</td>" for column in columns)
    return f"<table><tr>{cells}</tr></table>"


def _table(name: str, rows: Sequence[tuple[str, str]]) -> str:
    cells = (f"<tr><td style='padding: 0 16px 0 0'>{escape(a)}</td><td>{escape(b)}</td></tr>" for a, b in rows)
    return f"<p><b>{escape(name)}</b></p><table>{''.join(cells)}</table>"
