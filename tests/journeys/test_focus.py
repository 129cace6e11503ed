"""The keys go to the lanes unless something is typed, whatever was pressed, hidden or switched off; Tab follows the eye."""

from __future__ import annotations

import itertools

from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QApplication, QPushButton, QSlider, QWidget
from pytestqt.qtbot import QtBot

from app.curves.tools import TOOLS
from app.theme import LIGHT
from app.window.focus import by_eye
from app.window.main_window import MainWindow
from engine.project import Media

LEFT, PLAIN, Key = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, Qt.Key


def reached(window: MainWindow) -> list[QWidget]:
    return list(by_eye(window.centralWidget()))


def with_sound(window: MainWindow) -> None:
    marks = window.session.document.marks.with_medium("audio", Media("audio", "slate.wav", "0" * 64, 0.0))
    window.session.document.set_marks(marks)


def test_a_click_on_ruler_face_or_lanes_takes_the_keys_from_a_note(window: MainWindow) -> None:
    for widget in (window.timeline, window.preview.face, window.curves):
        window.actions_by_name["drag_tool"].trigger()
        window.notes.entry.setFocus()
        target = widget.viewport() if widget is window.curves else widget
        QTest.mouseClick(target, LEFT, PLAIN, QPoint(target.width() // 2, 10))
        assert widget.hasFocus()
        QTest.keyClick(QApplication.focusWidget(), Key.Key_P)
        assert window.session.view.tool == "pin" and window.notes.entry.text() == ""


def test_a_fill_is_kept_by_the_key_after_it_was_made_by_the_mouse(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    session.view.select((session.document.marks.spans[0].start, session.document.marks.spans[0].stop))
    window.notes.entry.setFocus()
    QTest.mouseClick(window.spans.fill_button, LEFT)
    assert window.curves.hasFocus()
    qtbot.waitUntil(lambda: bool(window.filling.variants) and not window.filling.busy, timeout=60_000)
    assert window.curves.hasFocus()
    QTest.keyClick(QApplication.focusWidget(), Key.Key_Return)
    qtbot.waitUntil(lambda: session.document.undo.count() == 1, timeout=10_000)
    assert window.curves.hasFocus() and window.notes.entry.text() == ""


def test_a_tool_switch_gives_the_keys_to_the_lanes_and_not_to_a_button(window: MainWindow) -> None:
    with_sound(window)
    for name in TOOLS:
        window.attached.boxes["audio"].away.setFocus()
        window.actions_by_name[f"{name}_tool"].trigger()
        assert window.curves.hasFocus()


def test_what_is_hidden_gives_the_focus_to_the_lanes(window: MainWindow) -> None:
    with_sound(window)
    seen = {window.curves}
    for tool in TOOLS:
        window.actions_by_name[f"{tool}_tool"].trigger()
        for widget in [each for each in reached(window) if each not in seen]:
            seen.add(widget)
            for hide, bring_back in (
                (widget.hide, widget.show),
                (lambda: widget.setEnabled(False), lambda: widget.setEnabled(True)),  # noqa: B023
            ):
                widget.setFocus()
                assert QApplication.focusWidget() is widget
                hide()
                assert window.curves.hasFocus(), widget
                bring_back()


def test_what_is_deleted_hands_the_keys_to_the_lanes(window: MainWindow) -> None:
    window.attached.boxes["audio"].away.setFocus()
    button = QPushButton("soon gone")
    window.notes.column.addWidget(button)
    button.show()
    button.setFocus()
    assert button.hasFocus()
    button.setParent(None)
    button.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    assert window.curves.hasFocus()


def test_tab_goes_through_everything_as_the_eye_does(window: MainWindow) -> None:
    with_sound(window)
    window.session.view.expand(0)
    for tool in TOOLS:
        window.actions_by_name[f"{tool}_tool"].trigger()
        QApplication.processEvents()
        assert_tab_follows_the_eye(window)


def assert_tab_follows_the_eye(window: MainWindow) -> None:
    expected = {
        each
        for each in window.centralWidget().findChildren(QWidget)
        if each.isVisible()
        and each.isEnabled()
        and each.focusPolicy() & Qt.FocusPolicy.TabFocus
        and not each.focusProxy()
    }
    visited: list[QWidget] = []
    for _ in range(len(expected) + 1):
        QTest.keyClick(QApplication.focusWidget(), Key.Key_Tab)
        visited.append(QApplication.focusWidget())
    assert visited.pop() is visited[0] and set(visited) == expected and len(expected) == len(visited)
    start = next(index for index, each in enumerate(visited) if each.accessibleName() == "Open…")
    order = [*visited[start:], *visited[:start]]
    areas = (window.preview, window.curves, window.inspector)
    columns = [at for each in order for at, area in enumerate(areas) if each is area or area.isAncestorOf(each)]
    assert columns == sorted(columns) and set(columns) == {0, 1, 2}
    for area in (window.preview, window.inspector):
        boxes = [each.rect().translated(each.mapTo(area, QPoint())) for each in order if area.isAncestorOf(each)]
        for before, after in itertools.pairwise(boxes):
            same_row = after.top() < before.bottom() and before.top() < after.bottom()
            assert after.left() >= before.right() if same_row else after.top() >= before.bottom()
    for previous in reversed(visited):
        QTest.keyClick(QApplication.focusWidget(), Key.Key_Backtab, Qt.KeyboardModifier.ShiftModifier)
        assert QApplication.focusWidget() is previous


def test_whatever_has_the_keys_shows_it(window: MainWindow) -> None:
    seen: set[QWidget] = set()
    for theme, tool in itertools.product(("dark", "light"), TOOLS):
        if (window.colours is LIGHT) != (theme == "light"):
            window.actions_by_name["light_theme"].trigger()
            seen.clear()
        window.actions_by_name[f"{tool}_tool"].trigger()
        for widget in [each for each in reached(window) if each not in seen]:
            seen.add(widget)
            window.timeline.setFocus()
            without = widget.grab().toImage()
            widget.setFocus(Qt.FocusReason.TabFocusReason)
            assert widget.grab().toImage() != without, (theme, widget, widget.accessibleName())


def test_what_tab_reached_is_used_by_the_keys(window: MainWindow) -> None:
    frame = window.session.view.playhead
    buttons = (each for each in reached(window) if isinstance(each, QAbstractButton) and each.isCheckable())
    box = next(each for each in buttons if not each.isChecked())  # a tool in hand is not put down by its own key
    box.setFocus(Qt.FocusReason.TabFocusReason)
    QTest.keyClick(box, Key.Key_Space)
    assert box.isChecked() and not window.transport.playing
    slider = next(each for each in reached(window) if isinstance(each, QSlider))
    slider.setFocus(Qt.FocusReason.TabFocusReason)
    value = slider.value()
    QTest.keyClick(slider, Key.Key_Right)
    assert slider.value() > value and window.session.view.playhead == frame
    QTest.keyClick(slider, Key.Key_Space)
    assert window.transport.playing


def test_a_press_on_a_slider_or_a_button_leaves_the_keys_to_the_lanes(window: MainWindow) -> None:
    pressed = [each for each in reached(window) if isinstance(each, QSlider | QAbstractButton)]
    views = window.preview.findChildren(QAbstractButton)
    for widget in [each for each in pressed if isinstance(each, QSlider)] + views:
        window.notes.entry.setFocus()
        QTest.mouseClick(widget, LEFT)
        assert window.curves.hasFocus(), widget


def test_a_letter_that_is_typed_shows_nothing(window: MainWindow) -> None:
    window.notes.entry.setFocus()
    QTest.keyPress(window.notes.entry, Key.Key_B)
    assert window.preview.face.view == "After" and window.notes.entry.text() == "b"


def test_the_original_is_shown_for_as_long_as_b_is_held(window: MainWindow) -> None:
    for view, end in itertools.product(("After", "Split"), ("release", "with Shift", "elsewhere")):
        window.preview.show_view(view)
        QTest.keyPress(window.curves, Key.Key_B)
        assert window.preview.face.view == "Before"
        if end == "elsewhere":
            QApplication.sendEvent(window, QEvent(QEvent.Type.WindowDeactivate))
        else:
            held = Qt.KeyboardModifier.ShiftModifier if end == "with Shift" else PLAIN
            QTest.keyRelease(window.curves, Key.Key_B, held)
        assert window.preview.face.view == view
