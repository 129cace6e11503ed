"""A right click, or the menu key, offers what can be done with what lies there; what is chosen happens there."""

from __future__ import annotations

from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QContextMenuEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QPushButton, QScrollArea, QWidget
from pytestqt.qtbot import QtBot

from app.session import Change
from app.session.commands import MarkCommand
from app.window.main_window import MainWindow
from engine.project import Note, Pin, Span
from tests.journeys.conftest import noted, settled

Reason = QContextMenuEvent.Reason


def right_clicked(window: MainWindow, widget: QWidget, at: QPoint, reason: Reason = Reason.Mouse) -> QMenu:
    """Ask for the menu at a point of a widget, and return it."""
    QApplication.sendEvent(widget, QContextMenuEvent(reason, at, widget.mapToGlobal(at)))
    menu = window._contexts.menu
    assert menu is not None and menu.isVisible()
    return menu


def chosen(qtbot: QtBot, window: MainWindow, menu: QMenu, title: str) -> None:
    """Click an entry of a menu."""
    action = next(each for each in menu.actions() if each.text() == title)
    with qtbot.waitSignal(menu.destroyed):
        QTest.mouseClick(menu, Qt.MouseButton.LeftButton, pos=menu.actionGeometry(action).center())
    window.activateWindow()  # this platform does not, when a menu closes
    qtbot.waitUntil(window.isActiveWindow)


def listed(qtbot: QtBot, section: QWidget, words: str) -> QPushButton:
    """Return the button of a list that says something, when it is on screen."""

    def found() -> list[QPushButton]:
        return [each for each in section.findChildren(QPushButton) if words in each.text() and each.isVisible()]

    qtbot.waitUntil(lambda: len(found()) == 1)
    return found()[0]


def titles(menu: QMenu) -> list[str]:
    return [action.text() for action in menu.actions() if not action.isSeparator()]


def lane_point(window: MainWindow, lane: str, frame: float) -> QPoint:
    return QPoint(round(window.timeline.x_of(frame)), round(window.timeline.lane_box(lane).center().y()))


def curve_point(window: MainWindow, key: int, frame: float) -> QPoint:
    lane = window.curves.lane(key)
    return window.curves.mapFromScene(QPointF(lane.x_of(frame), lane.scene_box().center().y()))


def test_a_curve_is_closed_where_it_was_clicked(qtbot: QtBot, window: MainWindow) -> None:
    menu = right_clicked(window, window.curves.viewport(), curve_point(window, 0, 60))
    assert abs(window.session.view.playhead - 60) <= 1 and window.session.view.lane == 0
    chosen(qtbot, window, menu, "Close here")
    qtbot.waitUntil(lambda: window.session.document.undo.index() == 1, timeout=20_000)
    assert window.session.document.controls[window.session.view.playhead, 0] < 1.0
    settled(qtbot, window)


def test_the_name_of_a_curve_shows_its_weights(qtbot: QtBot, window: MainWindow) -> None:
    at = curve_point(window, 1, 60)
    menu = right_clicked(window, window.curves.viewport(), QPoint(20, at.y()))
    assert window.session.view.lane == 1 and window.session.view.expanded == frozenset()
    chosen(qtbot, window, menu, "Show or hide the weights below")
    assert window.session.view.expanded == {1}


def test_notes_are_changed_and_deleted_and_all_of_it_undone(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    session.view.move_playhead(100)
    noted(window, "lips miss the b")
    session.view.move_playhead(0)
    menu = right_clicked(window, window.timeline, lane_point(window, "notes", 100) + QPoint(3, 0))
    assert session.view.playhead == 100 and titles(menu)[0] == "lips miss the b"
    chosen(qtbot, window, menu, "Edit the note here")
    assert window.notes.entry.text() == "lips miss the b"
    QTest.keyClick(window.notes.entry, Qt.Key.Key_Escape)
    assert session.document.marks.notes[0].text == "lips miss the b" and window.notes.entry.text() == ""
    QTest.keyClick(window.curves, Qt.Key.Key_N, Qt.KeyboardModifier.ShiftModifier)
    QTest.keyClicks(window.notes.entry, "lips close late")
    QTest.keyClick(window.notes.entry, Qt.Key.Key_Return)
    assert [(note.frame, note.text) for note in session.document.marks.notes] == [(100, "lips close late")]
    button = listed(qtbot, window.notes, "lips")
    chosen(qtbot, window, right_clicked(window, button, QPoint(5, 5)), "Delete the note here")
    assert session.document.marks.notes == () and session.document.undo.undoText() == "delete a note"
    session.document.undo.undo()
    session.document.undo.undo()
    assert [note.text for note in session.document.marks.notes] == ["lips miss the b"]


def test_emptying_a_note_deletes_it_and_one_that_is_undone_meanwhile_is_not_changed(
    qtbot: QtBot, window: MainWindow
) -> None:
    noted(window, "first")
    window.marks.edit_note()
    window.session.document.undo.undo()
    assert window.notes.entry.text() == ""
    window.session.document.undo.redo()
    window.marks.edit_note()
    window.notes.entry.clear()
    QTest.keyClick(window.notes.entry, Qt.Key.Key_Return)
    assert window.session.document.marks.notes == () and window.session.document.undo.undoText() == "delete a note"


def test_a_pin_is_removed_and_comes_back(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    pinned = replace(session.document.marks, pins=(Pin(40, {"jawOpen": 0.4}, 30, 50),))
    session.document.undo.push(MarkCommand.of(session.document, pinned, "pin"))
    menu = right_clicked(window, window.timeline, lane_point(window, "pins", 40))
    assert session.view.playhead == 40
    chosen(qtbot, window, menu, "Remove the pin here")
    assert session.document.marks.pins == ()
    session.document.undo.undo()
    assert session.document.marks.pins == pinned.pins


def test_a_span_is_unmarked_from_its_lane_and_from_the_list(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    before = session.document.marks
    session.document.undo.push(
        MarkCommand.of(session.document, replace(before, spans=(Span(20, 40), *before.spans)), "mark a span")
    )
    menu = right_clicked(window, window.timeline, lane_point(window, "spans", 30))
    assert session.view.selection == (20, 40) and "Fill the span" in titles(menu)
    chosen(qtbot, window, menu, "Unmark the span")
    assert session.document.marks == before
    session.document.undo.undo()
    button = listed(qtbot, window.spans, "20 frames")
    menu = right_clicked(window, button, QPoint(4, 4))
    chosen(qtbot, window, menu, "Unmark the span")
    assert session.document.marks == before


def test_a_flag_says_what_it_is_however_one_comes_to_it(qtbot: QtBot, window: MainWindow) -> None:
    session, section = window.session, window.flags
    flag = (session.document.flags or ())[0]
    QTest.keyClick(window.curves, Qt.Key.Key_Down)
    assert session.view.playhead == flag.start
    assert window.status["notice"].text() == section.here.text() == flag.sentence
    assert section.list.currentRow() == 0 and "1 finding" in section.count.text()
    session.view.move_playhead(0)
    assert section.here.isHidden()
    item = section.list.visualItemRect(section.list.item(0)).center()
    window.inspector.findChild(QScrollArea).ensureWidgetVisible(section.list)
    QTest.mouseClick(section.list.viewport(), Qt.MouseButton.LeftButton, pos=item)
    assert session.view.playhead == flag.start and section.here.text() == flag.sentence
    session.view.move_playhead(0)
    menu = right_clicked(window, window.timeline, lane_point(window, "flags", flag.start))
    assert session.view.playhead == flag.start and titles(menu)[0].startswith(flag.sentence[:20])
    menu.close()


def test_the_face_is_seen_as_recorded_and_a_right_drag_still_pans(qtbot: QtBot, window: MainWindow) -> None:
    face = window.preview.face
    middle = face.rect().center()
    QTest.mouseClick(face, Qt.MouseButton.RightButton, pos=middle)
    menu = window._contexts.menu
    assert menu is not None
    chosen(qtbot, window, menu, "Show the recorded face")
    assert face.view == "Before" and window.actions_by_name["view_before"].isChecked()
    before = face.camera
    QTest.mousePress(face, Qt.MouseButton.RightButton, pos=middle)
    QTest.mouseMove(face, middle + QPoint(5, 0))
    QApplication.sendEvent(
        face, QContextMenuEvent(Reason.Mouse, middle, face.mapToGlobal(middle))
    )  # as some systems ask for it, on the press
    assert window._contexts.menu is None
    QTest.mouseRelease(face, Qt.MouseButton.RightButton, pos=middle + QPoint(60, 0))
    assert window._contexts.menu is None and face.camera is not None and before is not None
    settled(qtbot, window)


def test_the_menu_key_offers_all_that_is_at_the_playhead(qtbot: QtBot, window: MainWindow) -> None:
    window.session.view.move_playhead(50)
    noted(window, "here")
    menu = right_clicked(window, window.curves.viewport(), QPoint(1, 1), Reason.Keyboard)
    assert {"Edit the note here", "Close here", "Copy"} <= set(titles(menu)) and window.session.view.playhead == 50
    menu.close()


def test_a_label_of_retargeting_has_a_menu(qtbot: QtBot, window: MainWindow) -> None:
    labels = window.retarget.panel.labels
    labels._lay_out_list([30])
    menu = right_clicked(window, labels.frames[30], QPoint(3, 3))
    assert window.session.view.playhead == 30 and "Remove the label of this frame" in titles(menu)
    menu.close()


def test_the_wheel_scrolls_the_lanes_and_zooms_with_ctrl(qtbot: QtBot, window: MainWindow) -> None:
    for lane in range(4):
        window.session.view.expand(lane)
    settled(qtbot, window)
    area = window.curves.parentWidget().parentWidget()
    assert isinstance(area, QScrollArea) and area.verticalScrollBar().maximum() > 0
    view = window.session.view.range
    turned(window, Qt.KeyboardModifier.NoModifier)
    assert area.verticalScrollBar().value() > 0 and window.session.view.range == view
    turned(window, Qt.KeyboardModifier.ControlModifier, notches=1)
    assert window.session.view.range != view


def turned(window: MainWindow, modifier: Qt.KeyboardModifier, notches: int = -1) -> None:
    """Turn the wheel over the lanes, away from oneself where `notches` are positive."""
    at = window.curves.mapTo(window, QPoint(300, window.curves.visibleRegion().boundingRect().center().y()))
    QTest.wheelEvent(window.windowHandle(), QPointF(at), QPoint(0, 120 * notches), QPoint(), modifier)


@pytest.mark.parametrize("key", [Qt.Key.Key_K, Qt.Key.Key_Space])
def test_k_plays_and_pauses(qtbot: QtBot, window: MainWindow, key: Qt.Key) -> None:
    QTest.keyClick(window.curves, key)
    assert window.transport.playing and window.session.view.tool == "drag"
    QTest.keyClick(window.curves, key)
    assert not window.transport.playing


def test_a_fill_that_is_kept_is_no_span_to_work_on(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    (lost,) = (span for span in session.document.marks.spans if span.kind == "lost")
    assert session.document.open_spans == session.document.marks.spans
    session.view.select((lost.start, lost.stop))
    window.spans.style_box.setCurrentText("a smooth bridge")
    window.spans.fill()
    qtbot.waitUntil(lambda: bool(window.filling.variants), timeout=60_000)
    window.filling.accept()
    assert lost in session.document.marks.spans and lost not in session.document.open_spans
    assert window.curves._underlay.spans == []
    listed(qtbot, window.spans, "filled")
    session.document.undo.undo()
    assert lost in session.document.open_spans and len(window.curves._underlay.spans) == 1
    settled(qtbot, window)


def test_hostile_region_and_many_spans_are_listed_in_time(window: MainWindow) -> None:
    spans = tuple(Span(frame, frame + 1, kind="lost") for frame in range(len(window.session.document.take)))
    window.session.document.set_marks(replace(window.session.document.marks, spans=spans, notes=(Note(0, "", "", ""),)))
    window.session.changed.emit(Change.CURVES)
    lost = int(window.session.document.take.lost.sum())
    assert len(window.session.document.open_spans) == lost
