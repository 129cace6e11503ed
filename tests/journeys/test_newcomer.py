"""Somebody who has read nothing: what the window tells must be whole, true, and stay where it is."""

from __future__ import annotations

from pathlib import Path

import pytest
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QToolButton
from pytestqt.qtbot import QtBot

from app.actions.table import ACTIONS, keys_of
from app.dialogs.page import Page
from app.widgets.hints import BETWEEN
from app.window.main_window import MainWindow
from engine.lab.performer import demo
from tests.journeys.conftest import load, noted, saved_as, settled
from tests.journeys.test_non_expert import LIPS, drag
from tests.pictures.compare import SIZE


def buttons(window: MainWindow) -> dict[str, QRect]:
    """Return where the buttons of the toolbar are."""
    bar = window.menus.hints.parentWidget()
    return {each.accessibleName(): each.geometry() for each in bar.findChildren(QToolButton)}


def test_hints_follow_the_work_and_move_no_button(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window.resize(1440, 900)
    settled(qtbot, window)
    hints, places = window.menus.hints, buttons(window)
    assert all(word in hints.text() for word in ("Drag a curve", "Space plays", "F fills"))
    drag(qtbot, window, LIPS, 130, -6.0)
    assert "Ctrl+Z takes it back" in hints.text() and "Ctrl+S saves" in hints.text()
    assert buttons(window) == places
    saved_as(qtbot, window, tmp_path / "first.retake", monkeypatch)
    assert hints.text() == ""
    assert buttons(window) == places


@pytest.mark.parametrize("width", [1120, 1280, 1366, 1440, 1920])
def test_only_whole_hints_are_shown(qtbot: QtBot, window: MainWindow, width: int) -> None:
    window.resize(width, 800)
    qtbot.wait(20)
    hints = window.menus.hints
    told = hints.toolTip().splitlines()
    shown = hints.text().split(BETWEEN) if hints.text() else []
    assert shown == told[: len(shown)] and (shown or width < 1280)
    assert hints.fontMetrics().horizontalAdvance(hints.text()) <= hints.width()


def test_the_only_span_is_filled_without_choosing_it_and_enter_in_an_entry_keeps_no_fill(
    qtbot: QtBot, window: MainWindow
) -> None:
    session = window.session
    QTest.keyClick(window, Qt.Key.Key_F)
    qtbot.waitUntil(lambda: bool(window.filling.variants), timeout=60_000)
    assert session.view.selection == (session.document.marks.spans[0].start, session.document.marks.spans[0].stop)
    assert not window.notices.isVisible()
    window.notes.entry.setFocus()
    noted(window, "lost here")
    assert [note.text for note in session.document.marks.notes] == ["lost here"]
    window.brush.radius.setFocus()
    QTest.keyClick(window.brush.radius, Qt.Key.Key_Return)
    assert window.filling.variants and session.document.take.weights is session.document.original.weights
    window.curves.setFocus()
    QTest.keyClick(window.curves, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: session.document.undo.count() == 2, timeout=10_000)
    settled(qtbot, window)


def test_all_keys_stand_on_one_page_that_fits_the_window(qtbot: QtBot, window: MainWindow) -> None:
    window.resize(*SIZE)
    QTest.keyClick(window, Qt.Key.Key_F1)
    (page,) = [each for each in QApplication.topLevelWidgets() if isinstance(each, Page) and each.isVisible()]
    assert page.width() <= SIZE[0] and page.height() <= SIZE[1]
    told = page.text.text()
    assert all(entry.title.rstrip("…") in told.replace("&#x27;", "'") for entry in ACTIONS if keys_of(entry, "Retake"))
    assert "hold B" in told
    qtbot.waitUntil(page.isActiveWindow)
    QTest.keyClick(page, Qt.Key.Key_Escape)
    assert not page.isVisible()


def test_a_take_of_one_frame_has_curves(qtbot: QtBot, window: MainWindow, tmp_path: Path) -> None:
    header, *rows = demo.BUNDLED.read_text().splitlines()
    (tmp_path / "one.csv").write_text(f"{header}\n{rows[40]}\n")
    load(qtbot, window, tmp_path / "one.csv")
    settled(qtbot, window)
    for lane in window.curves.lanes:
        box = lane.reached.boundingRect()
        assert box.width() > 0.5 and box.height() < 1e-6
    assert "1 frame ·" in window.status["length"].text()


def test_a_long_note_widens_nothing(qtbot: QtBot, window: MainWindow) -> None:
    width = window.notes.width()
    QTest.keyClicks(window.notes.entry, "WWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWW")
    QTest.keyClick(window.notes.entry, Qt.Key.Key_Return)
    qtbot.wait(20)
    assert window.notes.width() <= width  # less by the scroll bar that comes with it


def test_what_the_pointer_showed_goes_with_the_tool(qtbot: QtBot, window: MainWindow) -> None:
    QTest.mouseMove(window.curves.viewport(), QPoint(400, 60))
    qtbot.waitUntil(window.curves.readout.isVisible)
    QTest.keyClick(window, Qt.Key.Key_P)
    assert not window.curves.readout.isVisible()
