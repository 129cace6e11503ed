"""Keys that no action can have: one that counts for as long as it is held, and those of whatever is typed into."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QLineEdit,
    QPlainTextEdit,
    QSlider,
    QTextEdit,
    QWidget,
)

from app.preview.panel import PreviewPanel
from app.widgets.watching import Watcher
from app.window.focus import is_entry

# Editors claim letters, digits and what moves the cursor by themselves; these they would lose to shortcuts.
ENTERS = frozenset({Qt.Key.Key_Return, Qt.Key.Key_Enter})
STEPS = frozenset({Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_PageUp, Qt.Key.Key_PageDown})
ENDS = frozenset({Qt.Key.Key_Left, Qt.Key.Key_Right, Qt.Key.Key_Home, Qt.Key.Key_End})
COMMANDS = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.AltModifier | Qt.KeyboardModifier.MetaModifier


# What has the keys by Tab alone, since a press gives them to the lanes: without these it could be reached and not used.
OWN: tuple[tuple[type[QWidget], frozenset[Qt.Key]], ...] = (
    (QLineEdit, ENTERS | STEPS),
    (QAbstractSpinBox, ENTERS | STEPS),
    (QPlainTextEdit, ENTERS | STEPS),
    (QTextEdit, ENTERS | STEPS),
    (QAbstractButton, frozenset({Qt.Key.Key_Space})),
    (QComboBox, frozenset({Qt.Key.Key_Space}) | STEPS),
    (QSlider, STEPS | ENDS),
)
LEFT = frozenset({QEvent.Type.WindowDeactivate, QEvent.Type.ApplicationDeactivate})


class Keyboard(Watcher):
    """Watches the keys of the whole program until it is removed.

    Parameters
    ----------
    window : whose keys count
    preview : shows the original while B is held
    """

    def __init__(self, window: QWidget, preview: PreviewPanel) -> None:
        self._window, self._preview = window, preview
        self._view_before_hold: str | None = None
        super().__init__(window)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Show the original for as long as B is held; leave its keys to whatever is typed into."""
        kind = event.type()
        if kind in LEFT:
            self._hold_before(False)  # the release will not be seen
        if not isinstance(event, QKeyEvent):
            return False
        if kind == QEvent.Type.ShortcutOverride and isinstance(watched, QWidget):
            keys = next((keys for type_, keys in OWN if isinstance(watched, type_)), frozenset())
            commands = event.modifiers() & COMMANDS and event.key() not in ENTERS
            if event.key() in keys and not commands:
                event.accept()
                return True
            return False
        if event.key() == Qt.Key.Key_B and not event.isAutoRepeat():
            if kind == QEvent.Type.KeyRelease:
                self._hold_before(False)  # whatever other keys are down by now
            elif kind == QEvent.Type.KeyPress and event.modifiers() == Qt.KeyboardModifier.NoModifier:
                self._hold_before(self._counts())
        return False

    def _counts(self) -> bool:
        """Return whether a letter is a shortcut of the window, and not typed."""
        typed = QApplication.focusWidget()
        return self._window.isActiveWindow() and (typed is None or not is_entry(typed))

    def _hold_before(self, held: bool) -> None:
        if held and self._view_before_hold is None and self._preview.face.view != "Before":
            self._view_before_hold = self._preview.face.view
            self._preview.show_view("Before")
        elif not held and self._view_before_hold is not None:
            self._preview.show_view(self._view_before_hold)
            self._view_before_hold = None
