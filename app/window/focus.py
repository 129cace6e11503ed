"""Where the keys go: to the lanes, unless something is typed; Tab goes through what can be seen as the eye does."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QLabel,
    QLayout,
    QLineEdit,
    QMainWindow,
    QMenuBar,
    QPlainTextEdit,
    QScrollArea,
    QScrollBar,
    QSplitter,
    QTextEdit,
    QWidget,
)

from app.widgets.watching import Watcher

ENTRIES = (QLineEdit, QAbstractSpinBox, QPlainTextEdit, QTextEdit, QAbstractItemView)
BYSTANDERS = (QMenuBar, QScrollBar)  # a press on them changes nothing


def is_entry(widget: QWidget) -> bool:
    """Return whether a press on a widget begins typing, or selecting text."""
    if isinstance(widget, QComboBox):
        return widget.isEditable()
    chosen = isinstance(widget, QLabel) and widget.focusPolicy() != Qt.FocusPolicy.NoFocus
    return chosen or isinstance(widget, ENTRIES)


def by_eye(widget: QWidget | None) -> Iterator[QWidget]:
    """Yield what Tab reaches in a widget, itself included, in the order of its layouts: from the left, from the top."""
    if widget is None or not widget.isVisible():
        return
    reached = widget.focusPolicy() & Qt.FocusPolicy.TabFocus and widget.isEnabled() and widget.focusProxy() is None
    if reached:
        yield widget
    layout = widget.layout()
    if isinstance(widget, QScrollArea):
        yield from by_eye(widget.widget())
    elif isinstance(widget, QSplitter):
        for index in range(widget.count()):
            yield from by_eye(widget.widget(index))
    elif layout is not None and not reached:
        yield from _in_layout(layout)


def _in_layout(layout: QLayout) -> Iterator[QWidget]:
    for index in range(layout.count()):
        item = layout.itemAt(index)
        if item is None:
            continue
        inner, widget = item.layout(), item.widget()
        if widget is not None:
            yield from by_eye(widget)
        elif inner is not None:
            yield from _in_layout(inner)


class Focus(Watcher):
    """Gives the keys back to the lanes whenever what had them is done, hidden or switched off.

    Parameters
    ----------
    window : whose keys
    lanes : what the keys go to
    canvases : take the keys themselves when they are pressed
    """

    def __init__(self, window: QMainWindow, lanes: QWidget, canvases: Sequence[QWidget]) -> None:
        root = window.centralWidget()
        assert root is not None
        self._window, self._root, self._lanes = window, root, lanes
        self._canvases = tuple(canvases)
        for canvas in canvases:
            canvas.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        for area in root.findChildren(QScrollArea):
            area.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # it has nothing to do with keys, and would show no ring
        super().__init__(window)
        application = QApplication.instance()
        assert isinstance(application, QApplication)
        application.focusChanged.connect(self._on_focus)

    def remove(self) -> None:
        """Watch no longer."""
        super().remove()
        application = QApplication.instance()
        if isinstance(application, QApplication):
            application.focusChanged.disconnect(self._on_focus)

    def give_back(self) -> None:
        """Let the keys go to the lanes."""
        self._lanes.setFocus(Qt.FocusReason.OtherFocusReason)

    def step(self, onwards: bool) -> bool:
        """Go to the next, or the one before; from what is not there any more to the lanes."""
        now = self._window.focusWidget()
        order = list(by_eye(self._root))
        if now is None or not now.isVisible() or not now.isEnabled() or not order:
            self.give_back()
            return True
        at = order.index(now) if now in order else -1 if onwards else 0
        following = order[(at + (1 if onwards else -1)) % len(order)]
        following.setFocus(Qt.FocusReason.TabFocusReason if onwards else Qt.FocusReason.BacktabFocusReason)
        area = following.parentWidget()
        while area is not None:
            if isinstance(area, QScrollArea):
                area.ensureWidgetVisible(following)
            area = area.parentWidget()
        return True

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Take the keys from what was typed into, when something else is pressed."""
        if (
            isinstance(event, QMouseEvent)
            and event.type() == QEvent.Type.MouseButtonPress
            and isinstance(watched, QWidget)
            and watched.window() is self._window
            and watched.childAt(event.position().toPoint()) is None  # else it is handed up from what was pressed
            and not self._keeps(watched)
        ):
            self.give_back()
        return False

    def _keeps(self, pressed: QWidget) -> bool:
        """Return whether a press leaves the keyboard focus where Qt sets it: an entry, a canvas, or what it does not change."""
        widget: QWidget | None = pressed
        while widget is not None and widget is not self._window:
            if is_entry(widget) or widget in self._canvases or widget is self._lanes or isinstance(widget, BYSTANDERS):
                return True
            widget = widget.parentWidget()
        return False

    def _on_focus(self, old: QWidget | None, new: QWidget | None) -> None:
        """Move the keyboard focus on where the widget that had it was removed."""
        if new is None and self._window.isActiveWindow() and QApplication.activePopupWidget() is None:
            self.give_back()
