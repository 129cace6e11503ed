"""How large the window is: as designed, or as much of it as the screen has room for."""

from __future__ import annotations

from PySide6.QtCore import QRect, QSize
from PySide6.QtWidgets import QWidget

DESIGNED = QSize(1440, 900)


def fitted(window: QRect, frame: QRect, available: QRect) -> QRect:
    """Return a window's box such that its frame, drawn around it by the desktop, lies on the part of the screen it may use.

    It is no larger than it was, and moved no further than it must be.
    """
    left, top = window.left() - frame.left(), window.top() - frame.top()
    right, bottom = frame.right() - window.right(), frame.bottom() - window.bottom()
    room = available.adjusted(left, top, -right, -bottom)
    size = window.size().boundedTo(room.size())
    x = min(max(window.left(), room.left()), room.right() + 1 - size.width())
    y = min(max(window.top(), room.top()), room.bottom() + 1 - size.height())
    return QRect(x, y, size.width(), size.height())


def stay_on_screen(window: QWidget) -> None:
    """Bring a window within the part of its screen that it may use; what fills the screen is left to the desktop."""
    screen = window.screen()
    if screen is None or window.isMaximized() or window.isFullScreen():
        return
    box = fitted(window.geometry(), window.frameGeometry(), screen.availableGeometry())
    if box != window.geometry():
        window.setGeometry(box)
