"""On a laptop's screen nothing that is pressed first lies below the fold, and nothing is cut off."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QPoint, QRect, QSize
from PySide6.QtWidgets import QAbstractButton, QApplication, QScrollArea, QWidget
from pytestqt.qtbot import QtBot

from app.curves.tools import TOOLS
from app.window.main_window import MainWindow
from app.window.screen import stay_on_screen
from tests.journeys.conftest import settled

SMALL = QSize(1280, 720)  # also 2560 x 1440 at 200 %


def seen(window: MainWindow, widget: QWidget) -> bool:
    """Tell whether all of a widget can be seen without scrolling."""
    box = QRect(widget.mapTo(window, QPoint()), widget.size())
    area = widget.parentWidget()
    while area is not None and area is not window:
        if isinstance(area.parentWidget(), QScrollArea):
            view = area.parentWidget().viewport() if area.parentWidget().viewport() is area else area
            if not QRect(view.mapTo(window, QPoint()), view.size()).contains(box):
                return False
        area = area.parentWidget()
    return window.rect().contains(box)


def test_the_window_is_no_larger_than_its_screen(window: MainWindow) -> None:
    window.resize(4000, 3000)
    stay_on_screen(window)
    available, least = window.screen().availableSize(), window.minimumSizeHint()
    assert window.height() <= max(available.height(), least.height())
    assert window.width() <= max(available.width(), least.width())


def test_a_frame_that_the_desktop_draws_late_hangs_over_no_edge(
    qtbot: QtBot, window: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    available = window.screen().availableGeometry()
    window.move(available.topLeft())
    QApplication.processEvents()
    window._framed = False
    monkeypatch.setattr(window, "frameGeometry", lambda: window.geometry().adjusted(-1, -31, 1, 1))
    window.move(available.topLeft() + QPoint(1, 1))
    qtbot.waitUntil(lambda: window.frameGeometry().top() >= available.top())
    window.move(available.topLeft())  # the user's own move is left alone
    QApplication.processEvents()
    assert window.pos() == available.topLeft()


def test_what_is_pressed_first_is_seen_with_every_tool(qtbot: QtBot, window: MainWindow) -> None:
    window.resize(SMALL)
    window.session.view.select(
        (window.session.document.marks.spans[0].start, window.session.document.marks.spans[0].stop)
    )
    below: list[str] = []
    for tool in TOOLS:
        window.actions_by_name[f"{tool}_tool"].trigger()
        QApplication.processEvents()
        qtbot.wait(1)
        first = [each for each in window.findChildren(QAbstractButton) if each.property("primary") and each.isVisible()]
        first = [each for each in first if each is not window.spans.fill_button]  # the toolbar has the same
        below += [f"{tool}: {button.text()}" for button in first if not seen(window, button)]
        assert window.size() == SMALL and seen(window, window.status) and seen(window, window.inspector)
    assert not below


@pytest.mark.parametrize("size", [QSize(1280, 720), QSize(1440, 900)])
def test_bars_and_panels_are_within_the_window(qtbot: QtBot, window: MainWindow, size: QSize) -> None:
    window.resize(size)
    window.notices.warn("take.csv is not a Live Link Face file.", "Export it from the app as CSV.")
    settled(qtbot, window)
    for part in (window.status, window.inspector, window.preview, window.timeline, window.notices):
        assert window.rect().contains(QRect(part.mapTo(window, QPoint()), part.size())), part
