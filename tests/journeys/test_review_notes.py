"""A reviewer writes on frames, ranges and the picture itself, answers, settles, and does all of it by keyboard."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.preview.wipe import Wipe
from app.window.main_window import MainWindow
from engine.lab.performer import demo
from engine.project import Note, Project
from engine.take import Array
from tests.journeys.conftest import load, noted, saved_as, settled
from tests.journeys.test_review import compared, edited

Key, LEFT = Qt.Key, Qt.MouseButton.LeftButton
CONTROL, SHIFT, ALT = (
    Qt.KeyboardModifier.ControlModifier,
    Qt.KeyboardModifier.ShiftModifier,
    Qt.KeyboardModifier.AltModifier,
)


def press(window: MainWindow, key: Qt.Key, modifiers: Qt.KeyboardModifier = Qt.KeyboardModifier.NoModifier) -> None:
    """Press a key where a keyboard's would go."""
    QTest.keyClick(QApplication.focusWidget() or window.curves, key, modifiers)


def types(text: str) -> None:
    """Type into whatever has the keys, then Enter."""
    QTest.keyClicks(QApplication.focusWidget(), text)
    QTest.keyClick(QApplication.focusWidget(), Key.Key_Return)


def test_an_edited_take_is_reviewed_by_keyboard_alone(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session, document = window.session, window.session.document
    window.settings.author = "Ana"
    compared(qtbot, window, edited(tmp_path / "b.csv", (60, 80), (150, 160)), monkeypatch)
    window.curves.setFocus()
    session.view.move_playhead(0)

    press(window, Key.Key_Down, ALT)
    assert session.view.selection == (60, 80)
    press(window, Key.Key_N)
    assert "frames 60 to 79" in window.notes.entry.placeholderText()
    types("the jaw pops")
    (note,) = document.marks.notes
    assert (note.frame, note.frames, note.text, note.author) == (60, 20, "the jaw pops", "Ana")
    assert window.curves.hasFocus()  # and the keys are keys again

    press(window, Key.Key_Down, ALT)
    assert session.view.selection == (150, 160)
    press(window, Key.Key_PageUp, ALT)
    assert session.view.playhead == 60
    press(window, Key.Key_N, SHIFT)
    types("the jaw pops open")
    press(window, Key.Key_N, CONTROL | SHIFT)
    types("ease it in")
    press(window, Key.Key_N, ALT)
    (note,) = document.marks.notes
    assert (note.frame, note.frames, note.text) == (60, 20, "the jaw pops open")
    assert [reply.text for reply in note.replies] == ["ease it in"] and note.resolved and note.resolved_by == "Ana"
    press(window, Key.Key_N, ALT)
    assert not document.marks.notes[0].resolved

    press(window, Key.Key_W, CONTROL | SHIFT)
    assert document.marks.verdict == ""  # a rejection has a reason
    types("one change pops")
    assert document.marks.verdict == "Needs work: one change pops" and window.curves.hasFocus()
    press(window, Key.Key_A, CONTROL | SHIFT)
    assert document.marks.verdict == "Approved"  # the reason of another verdict is none of this one
    press(window, Key.Key_Z, CONTROL)
    assert document.marks.verdict == "Needs work: one change pops"

    saved_as(qtbot, window, tmp_path / "a.retake", monkeypatch)
    kept = document.marks
    load(qtbot, window, demo.BUNDLED)
    load(qtbot, window, tmp_path / "a.retake")
    assert window.session.document.marks == kept
    for _ in range(6):
        press(window, Key.Key_Z, CONTROL)
    assert window.session.document.marks.notes == () and window.session.document.marks.verdicts == ()
    settled(qtbot, window)


def face_shown(window: MainWindow) -> Array:
    """What is on the face's widget, (height, width, 3)."""
    image = window.preview.face.grab().toImage().convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).astype(float)


def drawn(window: MainWindow, *places: QPoint) -> None:
    face = window.preview.face
    QTest.mousePress(face, LEFT, Qt.KeyboardModifier.NoModifier, places[0])
    for place in places[1:]:
        QTest.mouseMove(face, place)
    QTest.mouseRelease(face, LEFT, Qt.KeyboardModifier.NoModifier, places[-1])


def test_a_mark_on_the_picture_goes_with_its_note_and_lies_where_it_was_drawn(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    document, view, face = window.session.document, window.session.view, window.preview.face
    view.move_playhead(40)
    settled(qtbot, window)
    plain, camera = face_shown(window), face.camera
    press(window, Key.Key_D, SHIFT)
    assert window.notes.draw.isChecked()
    middle = face.rect().center()
    drawn(window, *(middle + QPoint(step * 10, 3 * step) for step in range(8)))
    assert face.camera == camera  # it drew, and turned nothing
    noted(window, "this corner")
    (note,) = document.marks.notes
    assert note.drawing is not None and len(note.drawing.strokes) == 1 and len(note.drawing.strokes[0]) == 8
    assert not window.notes.draw.isChecked() and face.marking.strokes == []
    changed = np.abs(face_shown(window) - plain).max(axis=2) > 30
    columns = np.flatnonzero(changed.any(axis=0))
    ratio = changed.shape[1] / face.width()
    assert columns.min() / ratio == pytest.approx(middle.x(), abs=6)
    assert columns.max() / ratio == pytest.approx(middle.x() + 70, abs=6)

    view.move_playhead(41)
    settled(qtbot, window)
    assert face.noted == ()
    view.move_playhead(40)
    face._move(camera.orbited(around_deg=20.0, above_deg=0.0))
    settled(qtbot, window)
    assert not (
        np.abs(face_shown(window) - np.array([240.0, 163.0, 208.0])).max(axis=2) < 3
    ).any()  # from elsewhere it would lie
    view.move_playhead(0)
    press(window, Key.Key_PageDown, ALT)
    assert view.playhead == 40 and face.camera == camera
    saved_as(qtbot, window, tmp_path / "a.retake", monkeypatch)
    assert Project.open(tmp_path / "a.retake", read_only=True).contents.marks.notes == (note,)
    press(window, Key.Key_Z, CONTROL)
    assert document.marks.notes == () and face.noted == ()
    settled(qtbot, window)


def test_what_is_drawn_without_a_note_is_discarded(qtbot: QtBot, window: MainWindow) -> None:
    face = window.preview.face
    press(window, Key.Key_4)
    press(window, Key.Key_D, SHIFT)
    assert face.view == "After"  # on two heads a line would mean both
    drawn(window, face.rect().center(), face.rect().center() + QPoint(30, 0))
    assert len(face.marking.strokes) == 1
    press(window, Key.Key_D, SHIFT)
    assert face.marking.strokes == [] and not face.marking.on
    assert window.session.document.marks.notes == ()
    settled(qtbot, window)


def test_the_line_between_before_and_after_is_dragged_and_stepped(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    compared(qtbot, window, edited(tmp_path / "b.csv", (60, 80)), monkeypatch)
    window.curves.setFocus()
    window.session.view.move_playhead(70)
    face, pictures = window.preview.face, {}
    for key, name in ((Key.Key_1, "Before"), (Key.Key_2, "After"), (Key.Key_3, "Wipe")):
        press(window, key)
        settled(qtbot, window)
        assert face.pictured == name
        pictures[name] = face_shown(window)
    width = pictures["Wipe"].shape[1]
    far = slice(120, -60)  # beside what is written at the top and the knob at the foot
    clear = 20  # px beside the line
    left, right = slice(0, width // 2 - clear), slice(width // 2 + clear, width)
    np.testing.assert_allclose(pictures["Wipe"][far, left], pictures["Before"][far, left], atol=3)
    np.testing.assert_allclose(pictures["Wipe"][far, right], pictures["After"][far, right], atol=3)

    camera, middle = face.camera, face.rect().center()
    submitted = window.preview.drawing.idle
    drawn(window, QPoint(face.width() // 2, middle.y()), QPoint(face.width() // 4, middle.y()))
    assert face.wipe.share == pytest.approx(0.25, abs=0.01) and face.camera == camera
    assert submitted and window.preview.drawing.idle  # nothing was drawn anew
    uncovered = slice(width // 4 + clear, width // 2)
    np.testing.assert_allclose(face_shown(window)[far, uncovered], pictures["After"][far, uncovered], atol=3)
    press(window, Key.Key_BracketRight, CONTROL)
    assert face.wipe.share == pytest.approx(0.30, abs=0.01)
    QTest.keyPress(window.curves, Key.Key_B)
    assert face.view == "Before"
    QTest.keyRelease(window.curves, Key.Key_B)
    assert face.view == "Wipe"
    settled(qtbot, window)


def test_the_line_never_leaves_the_picture() -> None:
    wipe = Wipe()
    for x in (-500.0, 1e9, float(100)):
        wipe.move_to(x, 100.0)
        assert wipe.is_at(wipe.share * 100.0, 100.0) and 0.0 < wipe.share < 1.0
    for _ in range(100):
        wipe.step(-1)
    assert wipe.share > 0.0


def test_a_note_shows_in_every_lane_and_its_range_on_the_timeline(qtbot: QtBot, window: MainWindow) -> None:
    view = window.session.view
    view.select((60, 91))
    view.move_playhead(70)
    noted(window, "<b>hold</b> the M & wait")
    assert window.curves._underlay.notes == [(60.0, 91.0)]
    timeline = window.timeline
    at = QPointF(timeline.x_of(85), timeline.lane_box("notes").center().y())
    assert timeline.told_at(at).startswith("<b>hold</b> the M & wait")  # as it was typed
    QTest.mouseClick(timeline, LEFT, Qt.KeyboardModifier.NoModifier, at.toPoint())
    assert view.playhead == 60
    window.notes.settle(window.session.document.marks.notes[0])
    assert window.curves._underlay.notes == []
    assert "✓ 1" in window.notes._list.itemAt(0).widget().text()
    settled(qtbot, window)


def test_open_notes_are_gone_through_in_turn_even_on_one_frame() -> None:
    from app.notes.steps import following

    notes = tuple(
        Note(frame, "", "", text, resolved_at="x" if text == "done" else "")
        for frame, text in (
            (5, "a"),
            (5, "b"),
            (7, "done"),
            (9, "c"),
        )
    )
    seen, here, chosen = [], 0, None
    while (note := following(notes, here, chosen, by=1)) is not None:
        seen.append(note.text)
        here, chosen = note.frame, note
    assert seen == ["a", "b", "c"]
    back = []
    while (note := following(notes, here, chosen, by=-1)) is not None:
        back.append(note.text)
        here, chosen = note.frame, note
    assert back == ["b", "a"]
