"""Keys that no action can have: one that counts for as long as it is held, and those of whatever is typed into."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QAbstractSpinBox, QApplication, QLineEdit, QWidget

from app.preview.panel import PreviewPanel

# Editors claim letters, digits and what moves the cursor by themselves; these they would lose to shortcuts.
ENTERS = frozenset({Qt.Key.Key_Return, Qt.Key.Key_Enter})
STEPS = frozenset({Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_PageUp, Qt.Key.Key_PageDown})
COMMANDS = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.AltModifier | Qt.KeyboardModifier.MetaModifier


class Keyboard(QObject):
    """Watches the keys of the whole program until it is let go.

    Parameters
    ----------
    window : whose keys count
    preview : shows the original while B is held
    """

    def __init__(self, window: QWidget, preview: PreviewPanel) -> None:
        super().__init__(window)
        self._window, self._preview = window, preview
        self._view_before_hold: str | None = None
        application = QApplication.instance()
        if application is not None:
            application.installEventFilter(self)

    def let_go(self) -> None:
        """Watch no longer."""
        application = QApplication.instance()
        if application is not None:
            application.removeEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Show the original for as long as B is held; leave its keys to whatever is typed into."""
        if not isinstance(event, QKeyEvent):
            return False
        kind = event.type()
        if kind == QEvent.Type.ShortcutOverride and isinstance(watched, (QLineEdit, QAbstractSpinBox)):
            typed = event.key() in ENTERS or (event.key() in STEPS and not event.modifiers() & COMMANDS)
            event.setAccepted(typed)
            return typed
        if kind in (QEvent.Type.KeyPress, QEvent.Type.KeyRelease):
            plain = event.key() == Qt.Key.Key_B and event.modifiers() == Qt.KeyboardModifier.NoModifier
            if plain and self._window.isActiveWindow() and not event.isAutoRepeat():
                self._hold_before(kind == QEvent.Type.KeyPress)
        return False

    def _hold_before(self, held: bool) -> None:
        if held and self._preview.face.view != "Before":
            self._view_before_hold = self._preview.face.view
            self._preview.show_view("Before")
        elif not held and self._view_before_hold is not None:
            self._preview.show_view(self._view_before_hold)
            self._view_before_hold = None
