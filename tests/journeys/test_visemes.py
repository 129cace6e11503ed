"""What is said, from a file: attached, corrected, saved with the project, and said by a fill."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDropEvent
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from engine.controls import CONTROL_INDEX
from engine.lab.performer import demo
from tests.journeys.conftest import load, saved_as, settled

LEFT, PLAIN = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
LIPS = CONTROL_INDEX["lips_vertical"]
CUES = "8.30\tD\n8.62\tA\n8.78\tC\n9.30\tX\n"


def attach(qtbot: QtBot, window: MainWindow, tmp_path: Path, content: str = CUES, ending: str = ".tsv") -> Path:
    path = tmp_path / f"said{ending}"
    path.write_text(content, encoding="utf-8")
    mime = QMimeData()
    mime.setUrls([QUrl.fromLocalFile(str(path))])
    action, button = Qt.DropAction.CopyAction, Qt.MouseButton.LeftButton
    window.dropEvent(QDropEvent(QPointF(5, 5), action, mime, button, PLAIN))
    return path


def on_lane(window: MainWindow, time_s: float) -> QPoint:
    timeline = window.timeline
    middle = timeline.lane_box("visemes").center().y()
    return QPoint(round(timeline.x_of(time_s * window.session.document.take.fps)), round(middle))


def test_dropped_corrected_saved_and_taken_back(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = window.session
    attach(qtbot, window, tmp_path)
    qtbot.waitUntil(lambda: session.document.visemes is not None, timeout=10_000)
    assert session.document.undo.undoText() == "attach said.tsv"
    qtbot.waitUntil(lambda: not window.timeline.lane_box("visemes").isEmpty(), timeout=5_000)
    session.view.set_range(240, 290)
    QTest.mousePress(window.timeline, LEFT, PLAIN, on_lane(window, 8.62))
    QTest.mouseMove(window.timeline, on_lane(window, 8.5))
    QTest.keyClick(window, Qt.Key.Key_Escape)  # a boundary that is held can be let go of
    QTest.mouseRelease(window.timeline, LEFT, PLAIN, on_lane(window, 8.5))
    assert session.document.undo.count() == 1
    QTest.mousePress(window.timeline, LEFT, PLAIN, on_lane(window, 8.62))
    QTest.mouseMove(window.timeline, on_lane(window, 8.7))
    QTest.mouseRelease(window.timeline, LEFT, PLAIN, on_lane(window, 8.7))
    assert abs(session.document.visemes.times_s[1, 0] - 8.7) < 0.01 and session.document.undo.count() == 2
    session.view.move_playhead(265)
    QTest.keyClick(window, Qt.Key.Key_V, Qt.KeyboardModifier.ShiftModifier)
    QTest.keyClicks(window.timeline.visemes.entry, "IY1")
    QTest.keyClick(window.timeline.visemes.entry, Qt.Key.Key_Return)
    said = session.document.visemes
    assert said.cues[2].label == "IY1" and session.document.undo.count() == 3

    saved_as(qtbot, window, tmp_path / "a.retake", monkeypatch)
    load(qtbot, window, demo.BUNDLED)
    assert session.document.visemes is None
    load(qtbot, window, tmp_path / "a.retake")
    assert (session.document.visemes.cues, session.document.visemes.originals) == (said.cues, said.originals)
    window.actions_by_name["restore_visemes"].trigger()
    assert session.document.visemes.cues == said.originals
    window.actions_by_name["remove_visemes"].trigger()
    assert session.document.visemes is None
    for _ in range(5):
        QTest.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert session.document.visemes is None and session.document.undo.index() == 0
    for _ in range(3):
        QTest.keyClick(window, Qt.Key.Key_Y, Qt.KeyboardModifier.ControlModifier)
    assert session.document.visemes.cues == said.cues
    settled(qtbot, window)


def test_a_fill_says_the_visemes_unless_switched_off(qtbot: QtBot, window: MainWindow, tmp_path: Path) -> None:
    session = window.session
    (lost,) = session.document.marks.spans
    session.view.select((lost.start, lost.stop))
    assert not window.spans.visemes.isVisible()  # there are none
    attach(qtbot, window, tmp_path)
    qtbot.waitUntil(lambda: session.document.visemes is not None, timeout=10_000)
    assert window.spans.visemes.isVisible() and window.spans.visemes.isChecked()
    start, stop = session.document.visemes.frames_of(1, session.document.take.fps)
    lips = []
    for _ in range(2):
        QTest.keyClick(window, Qt.Key.Key_F)
        qtbot.waitUntil(lambda: bool(window.filling.variants), timeout=60_000)
        lips.append(
            [patch.reached[start - patch.start : stop - patch.start, LIPS] for patch in window.filling.variants]
        )
        made = window.filling._shown
        QTest.keyClick(window, Qt.Key.Key_Escape)
        window.spans.visemes.setChecked(False)
    assert made.stored["visemes"] == []
    assert max(curve.min() for curve in lips[0]) < 2.0  # in every variant the lips meet where M, B or P is said
    assert np.mean([curve.mean() for curve in lips[0]]) < np.mean([curve.mean() for curve in lips[1]])


def test_up_and_down_go_through_flags_and_spans(qtbot: QtBot, window: MainWindow, tmp_path: Path) -> None:
    session = window.session
    attach(qtbot, window, tmp_path, "1.00\tX\n2.75\tA\n2.85\tX\n9.00\tX\n")
    qtbot.waitUntil(lambda: any(flag.kind == "open" for flag in session.document.flags or ()), timeout=10_000)
    (missing,) = [flag for flag in session.document.flags if flag.kind == "open"]
    (lost,) = session.document.marks.spans
    QTest.keyClick(window, Qt.Key.Key_Down)
    assert session.view.playhead == missing.start and session.view.selection is None
    QTest.keyClick(window, Qt.Key.Key_Down)
    assert session.view.playhead == lost.start and session.view.selection == (lost.start, lost.stop)
    QTest.keyClick(window, Qt.Key.Key_Down)
    assert session.view.playhead == lost.start
    QTest.keyClick(window, Qt.Key.Key_Up)
    assert session.view.playhead == missing.start and session.view.selection is None


@pytest.mark.parametrize("content", ["", "0.1\tZ\n", "hello"])
def test_a_file_that_says_nothing_is_one_sentence(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, content: str
) -> None:
    attach(qtbot, window, tmp_path, content)
    qtbot.waitUntil(window.notices.isVisible, timeout=10_000)
    assert "said.tsv" in window.notices.text.text() and window.session.document.visemes is None
    window.actions_by_name["name_viseme"].trigger()
    assert "No viseme" in window.notices.text.text()
