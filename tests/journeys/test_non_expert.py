"""The non-expert: open, drag, see the face follow, undo, redo, save, open again."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog, QMessageBox
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from engine.controls import CONTROL_INDEX
from engine.extended import bundled_face
from engine.formats import read_take
from engine.lab.performer import demo
from tests.engine.project.projects import same
from tests.journeys.conftest import load, saved_as, settled
from tests.pictures.compare import SIZE, looks_as_it_did

LIPS = CONTROL_INDEX["lips_vertical"]


def pixels(window: MainWindow) -> np.ndarray:
    image = window.preview.face.image.convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : 3 * image.width()].copy()


def on_curve(window: MainWindow, lane: int, frame: int) -> QPoint:
    shown = window.curves.lanes[lane]
    value = float(window.session.document.controls[frame, lane])
    return window.curves.mapFromScene(shown.x_of(frame), shown.y_of(value))


def drag(qtbot: QtBot, window: MainWindow, lane: int, frame: int, by_mm: float) -> None:
    area = window.curves.viewport()
    window.session.view.choose_lane(lane)
    window.session.view.move_playhead(frame)
    settled(qtbot, window)
    start = on_curve(window, lane, frame)
    shown = window.curves.lanes[lane]
    per_mm = shown.y_of(1.0) - shown.y_of(0.0)
    QTest.mouseMove(area, start)
    QTest.mousePress(area, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, start)
    for part in (0.25, 0.5, 0.75, 1.0):
        QTest.mouseMove(area, start + QPoint(0, round(part * by_mm * per_mm)))
        qtbot.waitUntil(lambda: window.session.document.draft is not None, timeout=10_000)
    end = start + QPoint(0, round(by_mm * per_mm))
    steps = window.session.document.undo.count()
    QTest.mouseRelease(area, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, end)
    qtbot.waitUntil(lambda: window.session.document.undo.count() == steps + 1, timeout=10_000)
    settled(qtbot, window)


def test_a_drag_changes_curve_weights_and_picture_and_one_undo_restores_them(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch
) -> None:
    session = window.session
    frame = int(np.argmax(session.document.controls[:, LIPS]))
    session.view.move_playhead(frame)
    settled(qtbot, window)
    before = session.document.take.weights.copy(), session.document.controls.copy(), pixels(window)

    drag(qtbot, window, LIPS, frame, -10.0)
    after = session.document.take.weights.copy(), session.document.controls.copy(), pixels(window)
    assert session.document.controls[frame, LIPS] < before[1][frame, LIPS] - 6.0
    assert np.abs(after[0] - before[0]).max() > 0.1
    assert (after[2] != before[2]).mean() > 0.005
    far = np.abs(np.arange(len(session.document.take)) - frame) > 60
    np.testing.assert_array_equal(after[0][far], before[0][far])
    np.testing.assert_allclose(
        session.document.controls, bundled_face().measure(session.document.take.weights), atol=1e-9
    )

    QTest.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    settled(qtbot, window)
    for restored, original in zip(
        (session.document.take.weights, session.document.controls, pixels(window)), before, strict=True
    ):
        np.testing.assert_array_equal(restored, original)

    QTest.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier)
    settled(qtbot, window)
    for again, edited in zip(
        (session.document.take.weights, session.document.controls, pixels(window)), after, strict=True
    ):
        np.testing.assert_array_equal(again, edited)

    project, exported = tmp_path / "Ärger 顔.retake", tmp_path / "Ärger 顔.csv"
    saved_as(qtbot, window, project, monkeypatch)
    assert not session.document.edited
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(exported), ""))
    QTest.keyClick(window, Qt.Key.Key_E, Qt.KeyboardModifier.ControlModifier)
    np.testing.assert_allclose(read_take(exported).weights, session.document.take.weights, atol=1e-8)

    load(qtbot, window, exported)
    np.testing.assert_allclose(session.document.take.weights, after[0], atol=1e-8)
    load(qtbot, window, project)
    np.testing.assert_array_equal(session.document.take.weights, after[0])
    QTest.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    settled(qtbot, window)
    np.testing.assert_array_equal(session.document.take.weights, before[0])


def test_a_curve_dragged_up_and_back_is_as_it_was_and_the_largest_change_is_shown(
    qtbot: QtBot, window: MainWindow
) -> None:
    session = window.session
    before = session.document.curve(LIPS).copy()
    frame = int(np.argmin(before[60:-60])) + 60
    drag(qtbot, window, LIPS, frame, 15.0)
    assert session.document.curve(LIPS)[frame] > before[frame] + 10.0
    session.view.move_playhead(0)
    assert window.facts.outcome.text().endswith(f"(frame {frame:,})")
    drag(qtbot, window, LIPS, frame, before[frame] - session.document.curve(LIPS)[frame])
    np.testing.assert_allclose(session.document.curve(LIPS), before, atol=1.0)


def test_play_and_step_by_keys(qtbot: QtBot, window: MainWindow) -> None:
    QTest.keyClick(window, Qt.Key.Key_Right)
    QTest.keyClick(window, Qt.Key.Key_Right)
    QTest.keyClick(window, Qt.Key.Key_Left)
    assert window.session.view.playhead == 1
    QTest.keyClick(window, Qt.Key.Key_Space)
    qtbot.waitUntil(lambda: window.session.view.playhead > 8, timeout=10_000)
    QTest.keyClick(window, Qt.Key.Key_Space)
    assert not window.transport.playing
    QTest.keyClick(window, Qt.Key.Key_Down)
    assert window.session.document.take.lost[window.session.view.playhead]


def test_escape_cancels_the_drag(qtbot: QtBot, window: MainWindow) -> None:
    area, start = window.curves.viewport(), on_curve(window, LIPS, 80)
    QTest.mousePress(area, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, start)
    QTest.mouseMove(area, start + QPoint(0, 40))
    qtbot.waitUntil(lambda: window.session.document.draft is not None, timeout=10_000)
    QTest.keyClick(window, Qt.Key.Key_Escape)
    QTest.mouseRelease(area, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, start)
    settled(qtbot, window)
    assert window.session.document.draft is None and window.session.document.undo.count() == 0


def test_close_here_shuts_the_lips_on_the_selection(qtbot: QtBot, window: MainWindow) -> None:
    window.session.view.choose_lane(LIPS)
    window.session.view.select((70, 90))
    QTest.mouseClick(window.value.close_button, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: window.session.document.undo.count() == 1, timeout=10_000)
    assert window.session.document.controls[70:90, LIPS].max() < 2.0
    assert window.session.document.undo.undoText() == "close lips apart"


def test_a_file_that_cannot_be_read_leaves_the_work_as_it_was(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        QMessageBox, "question", lambda *_: QMessageBox.StandardButton.Discard
    )  # and is kept all the same
    drag(qtbot, window, LIPS, 80, -4.0)
    take = window.session.document.take
    for name, content in (("a.csv", b""), ("b.csv", b"\x89PNG\r\n\x1a\n" + bytes(200)), ("c.csv", b"hello, world\n")):
        (tmp_path / name).write_bytes(content)
        with qtbot.waitSignal(window.files.message, timeout=20_000):
            window.load(tmp_path / name)
        assert window.notices.isVisible() and name in window.notices.text.text()
        assert "Traceback" not in window.notices.text.text()
    assert window.session.document.take is take and window.session.document.undo.count() == 1


def test_from_opening_to_reopening_everything_is_equal(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Open, drag, undo, redo, play, save and reopen by keys and mouse alone: what comes back is what was left."""
    session, control = window.session, Qt.KeyboardModifier.ControlModifier
    take, project = Path(shutil.copy(demo.BUNDLED, tmp_path / "mine.csv")), tmp_path / "mine.retake"
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(take), ""))
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(project), ""))
    window.resize(*SIZE)
    with qtbot.waitSignal(window.files.opened, timeout=10_000):
        QTest.keyClick(window, Qt.Key.Key_O, control)
    assert session.document.path == take
    opened = session.document.take

    frame = int(np.argmax(session.document.controls[:200, LIPS]))
    drag(qtbot, window, LIPS, frame, -9.0)
    edited = session.document.take
    QTest.keyClick(window, Qt.Key.Key_Z, control)
    np.testing.assert_array_equal(session.document.take.weights, opened.weights)
    QTest.keyClick(window, Qt.Key.Key_Y, control)
    np.testing.assert_array_equal(session.document.take.weights, edited.weights)

    QTest.keyClick(window, Qt.Key.Key_Left, Qt.KeyboardModifier.ShiftModifier)
    QTest.keyClick(window, Qt.Key.Key_Space)
    qtbot.waitUntil(lambda: session.view.playhead > 10, timeout=10_000)
    QTest.keyClick(window, Qt.Key.Key_Space)
    QTest.keyClick(window, Qt.Key.Key_S, control)
    qtbot.waitUntil(lambda: not session.document.edited, timeout=10_000)
    assert project.exists()
    left = session.document.contents()
    asked, controls = session.document.asked, session.document.controls

    window.load(demo.BUNDLED)
    qtbot.waitUntil(lambda: session.document.path == demo.BUNDLED, timeout=10_000)
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(project), ""))
    QTest.keyClick(window, Qt.Key.Key_O, control)
    qtbot.waitUntil(lambda: session.document.path == project, timeout=10_000)
    assert not session.document.edited and same(session.document.contents(), left)
    np.testing.assert_array_equal(session.document.take.weights, edited.weights)
    np.testing.assert_array_equal(session.document.original.weights, opened.weights)
    np.testing.assert_array_equal(session.document.asked, asked)
    np.testing.assert_allclose(session.document.controls, controls, atol=1e-9)
    assert session.document.undo.undoText() == "drag lips apart"
    session.view.move_playhead(frame)
    settled(qtbot, window)
    assert looks_as_it_did(window, "journey_non_expert", tmp_path)
