"""What no hand does twice: files that are none, takes of a frame or two, and drags broken off in the middle."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDropEvent
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from engine.controls import CONTROL_INDEX
from engine.take import SHAPES, Take
from tests.conftest import ROOT
from tests.journeys.conftest import settled

LEFT, PLAIN = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
LIPS = CONTROL_INDEX["lips_vertical"]


def drop(window: MainWindow, path: Path) -> None:
    dropped = QMimeData()
    dropped.setUrls([QUrl.fromLocalFile(str(path))])
    window.dropEvent(QDropEvent(QPointF(50, 50), Qt.DropAction.CopyAction, dropped, LEFT, PLAIN))


def held(qtbot: QtBot, window: MainWindow, frame: int) -> QPoint:
    """Press on a curve and pull it a little; returns where the pointer is."""
    area, lane = window.curves.viewport(), window.curves.lane(LIPS)
    value = float(window.session.document.curve(LIPS)[frame])
    start = window.curves.mapFromScene(QPointF(lane.x_of(frame), lane.y_of(value)))
    QTest.mouseMove(area, start)
    QTest.mousePress(area, LEFT, PLAIN, start)
    QTest.mouseMove(area, start + QPoint(0, 12))
    qtbot.waitUntil(lambda: window.session.document.draft is not None, timeout=20_000)
    return start + QPoint(0, 12)


def release(qtbot: QtBot, window: MainWindow, at: QPoint) -> None:
    QTest.mouseMove(window.curves.viewport(), at + QPoint(0, 3))
    QTest.mouseRelease(window.curves.viewport(), LEFT, PLAIN, at)
    settled(qtbot, window)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes")
def test_dropped_files_that_are_none_leave_a_sentence_and_the_take(
    qtbot: QtBot, window: MainWindow, tmp_path: Path
) -> None:
    before = window.session.document.original
    for ending in (".csv", ".retake", ".trc", ".c3d", ".TextGrid", ".json", ".wav", ".mp4", ".txt"):
        for make in (os.mkfifo, Path.mkdir, Path.touch):
            path = tmp_path / f"{make.__name__}{ending}"
            make(path)
            window.notices.hide()
            drop(window, path)
            qtbot.waitUntil(window.notices.isVisible, timeout=10_000)
            assert path.name in window.notices.text.text()
            assert window.session.document.original is before


CASES = ROOT.parent / "shared" / "cases" / "hostile"
HOSTILE = {
    "cue.json": b'{"mouthCues": [{"start": 1' + b"0" * 300 + b', "end": 2, "value": "A"}]}',
    "brackets.TextGrid": b'"ooTextFile" "TextGrid" ' + b"[" * 40_000,
    "columns.csv": b"Timecode,BlendShapeCount," + b",".join(b"x%d" % n for n in range(900)) + b"\n" + b"0,0\n" * 60_000,
    "deep.json": b"[" * 100_000,
    "none.retake": b"SQLite format 3\0" + bytes(4000),
    "none.npz": b"PK\x03\x04" + bytes(400),
    "none.mp4": b"\0\0\0\x18ftypmp42" + bytes(400),
    "none.wav": b"RIFF\xff\xff\xff\xffWAVEfmt " + b"\xff" * 400,
    "none.c3d": b"\x02\x50" + b"\xff" * 1500,
}


COLLECTED = sorted(
    path.name for path in CASES.glob("MIN_*") if "html" not in path.name
)  # text as markup is tried elsewhere


@pytest.mark.parametrize("name", [*HOSTILE, *COLLECTED])
def test_a_file_made_to_harm_leaves_a_sentence_and_the_window(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, name: str
) -> None:
    before, path = window.session.document.original, tmp_path / name
    path.write_bytes(HOSTILE[name] if name in HOSTILE else (CASES / name).read_bytes())
    window.notices.hide()
    drop(window, path)
    qtbot.waitUntil(window.notices.isVisible, timeout=20_000)
    assert len(window.notices.text.text()) <= 310 and window.session.document.original is before
    settled(qtbot, window)


@pytest.mark.parametrize("frames", [1, 2])
def test_a_take_of_a_frame_or_two_is_edited_at_its_ends(qtbot: QtBot, window: MainWindow, frames: int) -> None:
    session = window.session
    session.open(Take(np.full((frames, len(SHAPES)), 0.2), 30.0, name="short"), None)
    settled(qtbot, window)
    for frame in (0, frames - 1):
        count = session.document.undo.count()
        release(qtbot, window, held(qtbot, window, frame))
        assert session.document.undo.count() == count + 1
    session.view.select((0, frames))
    for name in (
        "fill",
        "close_here",
        "copy",
        "paste",
        "smooth",
        "pin_tool",
        "clean_tool",
        "mark_tool",
        "carry",
        "play",
    ):
        window.actions_by_name[name].trigger()  # pytest-qt fails the test for what a slot raises
        settled(qtbot, window)
    window.transport.run(0.0)
    for _ in range(session.document.undo.count()):
        QTest.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    settled(qtbot, window)
    np.testing.assert_array_equal(session.document.take.weights, session.document.original.weights)


def test_a_drag_is_broken_off_by_escape_a_tool_or_another_take(
    qtbot: QtBot, window: MainWindow, tmp_path: Path
) -> None:
    session = window.session
    original = session.document.original.weights
    at = held(qtbot, window, 100)
    QTest.keyClick(window, Qt.Key.Key_Escape)
    release(qtbot, window, at)
    assert session.document.draft is None and session.document.undo.count() == 0
    for tool in ("draw", "scale", "pin", "mark", "drag"):
        at = held(qtbot, window, 100)
        session.view.choose_tool(tool)
        release(qtbot, window, at)
        session.view.choose_tool("drag")
        settled(qtbot, window)
        session.document.undo.setIndex(0)
        np.testing.assert_array_equal(session.document.take.weights, original)
    at = held(qtbot, window, 100)
    session.open(Take(np.full((2, len(SHAPES)), 0.2), 30.0, name="short"), None)
    release(qtbot, window, at)
    assert len(session.document.take) == 2 and session.document.draft is None
    np.testing.assert_array_equal(session.document.take.weights, session.document.original.weights)
