"""Text on widgets is plain: what a file, a packet or a reviewer says is never markup, a shortcut or a control code."""

from __future__ import annotations

import re
import textwrap

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtWidgets import QLabel, QMessageBox, QWidget

from app.widgets.watching import Watcher
from engine.words import NAME_LENGTH, plain

LABEL_LENGTH = 2000  # characters of a label of several lines
TIP_LENGTH, TIP_WIDTH = 1000, 80  # characters of a tooltip, and of one of its lines
CAPTION_LENGTH = 80  # characters of a button or a menu entry
BREAK_EVERY = 12  # characters, in words of twice that and more
_LONG_WORDS = re.compile(rf"\S{{{2 * BREAK_EVERY},}}")
PLAIN = Qt.TextFormat.PlainText


class Label(QLabel):
    """A label that shows its text as it is; every label of the program is one."""

    def __init__(self, text: str = "", parent: QWidget | None = None, *, longest: int = LABEL_LENGTH) -> None:
        super().__init__(parent)
        self._longest = longest
        self.setTextFormat(PLAIN)
        self.setText(text)

    def setText(self, text: str) -> None:
        """Show a text, without control codes and shortened in its middle where it is too long."""
        super().setText(_breakable(plain(text, lines=True, longest=self._longest)))


class Name(Label):
    """A label for a name in a line with other things: shortened, with all of it in the tooltip."""

    def __init__(self, text: str = "", parent: QWidget | None = None, *, longest: int = NAME_LENGTH) -> None:
        super().__init__(text, parent, longest=longest)

    def setText(self, text: str) -> None:
        """Show a name in one line."""
        QLabel.setText(self, plain(text, longest=self._longest))  # no place to break it at
        self.setToolTip(tip(text) if len(text) > self._longest else "")


def _breakable(text: str) -> str:
    """Return text whose very long words may be broken: a label is never narrower than its longest word."""
    return _LONG_WORDS.sub(lambda found: "\u200b".join(textwrap.wrap(found[0], BREAK_EVERY)), text)


def caption(text: str) -> str:
    """Return text for a button, a box to tick or a menu: of one line, where an ampersand is shown as one."""
    return plain(text, longest=CAPTION_LENGTH).replace("&", "&&")


def tip(text: str) -> str:
    """Return text for a tooltip: plain, its lines no wider than one reads at a glance."""
    lines = plain(text, lines=True, longest=TIP_LENGTH).split("\n")
    return "\n".join(part for line in lines for part in textwrap.wrap(line, TIP_WIDTH) or [""])


def title(text: str) -> str:
    """Return a name for a window's title, where Qt takes ``[*]`` for the place of its mark."""
    return plain(text, longest=NAME_LENGTH).replace("[*]", "[*][*]")


def message_box(parent: QWidget, heading: str, text: str) -> QMessageBox:
    """Return a box that says or asks something in plain text; the caller adds its buttons."""
    box = QMessageBox(parent)
    box.setTextFormat(PLAIN)
    box.setWindowTitle(title(heading))
    box.setText(plain(text, lines=True, longest=LABEL_LENGTH))
    return box


class PlainText(Watcher):
    """Makes labels plain that Qt itself builds, those of tooltips and of its dialogs, before they are first drawn.

    A label that shall show markup says so by its text format.
    """

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Set the text format of each label when it gets its looks."""
        unsaid = Qt.TextFormat.AutoText
        if event.type() == QEvent.Type.Polish and isinstance(watched, QLabel) and watched.textFormat() == unsaid:
            watched.setTextFormat(PLAIN)
        return False
