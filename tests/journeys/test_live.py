"""A phone's stream: listened to, shown, recorded and opened."""

from __future__ import annotations

import os
import socket
import threading

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QMessageBox
from pytestqt.qtbot import QtBot

from app.session import Session
from app.session.keeper import Keeper
from app.session.opening import Wish, opened
from app.window.main_window import MainWindow
from engine.formats import read_take
from engine.lab.performer import demo
from engine.live.replay import replay
from engine.take import Take

LEFT = Qt.MouseButton.LeftButton


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def test_a_stream_is_shown_recorded_and_opened(qtbot: QtBot, window: MainWindow) -> None:
    window.edits.live_tool()
    port = free_port()
    window.live.port.setValue(port)
    QTest.mouseClick(window.live.listen_button, LEFT)
    assert window.live.listening
    QTest.mouseClick(window.live.record_button, LEFT)
    sent = Take(weights=demo.performance().weights[:45], fps=30.0, name="sent")
    sender = threading.Thread(target=replay, args=(sent, ("127.0.0.1", port)))
    with qtbot.waitSignal(window.live.face, timeout=20_000) as shown:
        sender.start()
    assert np.asarray(shown.args[0]).shape == (52,)
    assert window.preview._frame_label.text() == "live"
    sender.join(timeout=20)
    qtbot.waitUntil(lambda: window.live.recording.frames >= 45, timeout=10_000)
    QTest.mouseClick(window.live.record_button, LEFT)
    assert len(window.session.document.take) == 45 and window.session.document.take.name == "live"
    np.testing.assert_allclose(window.session.document.take.weights, sent.weights, atol=1e-6)
    QTest.mouseClick(window.live.listen_button, LEFT)
    assert not window.live.listening
    assert window.preview._frame_label.text() == "frame 0"


def recording(qtbot: QtBot, window: MainWindow, sent: Take) -> None:
    """Listen, record, and wait until all that is sent has come."""
    window.edits.live_tool()
    port = free_port()
    window.live.port.setValue(port)
    QTest.mouseClick(window.live.listen_button, LEFT)
    QTest.mouseClick(window.live.record_button, LEFT)
    sender = threading.Thread(target=replay, args=(sent, ("127.0.0.1", port)))
    sender.start()
    qtbot.waitUntil(lambda: window.live.recording.frames >= len(sent), timeout=20_000)
    sender.join()


def test_a_recording_is_kept_until_it_is_saved(qtbot: QtBot, window: MainWindow) -> None:
    recording(qtbot, window, Take(weights=demo.performance().weights[:20], fps=30.0))
    with qtbot.waitSignal(window.keeper.kept, timeout=10_000):
        QTest.mouseClick(window.live.record_button, LEFT)
    assert window.session.document.edited  # closing asks
    assert [entry.suffix for entry in window.keeper.folder.iterdir() if entry.name[0] != "."] == [".retake"]


def test_a_window_closed_while_it_records_offers_the_recording_at_the_next_start(
    qtbot: QtBot, window: MainWindow
) -> None:
    sent = Take(weights=demo.performance().weights[:50], fps=30.0)
    recording(qtbot, window, sent)
    qtbot.waitUntil(lambda: sum(path.stat().st_size for path in window.keeper.folder.iterdir()) > 5_000, timeout=10_000)
    session = Session(demo.performance())
    keeper = Keeper(session, window.keeper.folder)
    try:
        for path in window.keeper.folder.glob("*.partial.csv"):
            os.utime(path, (1.0, 1.0))  # nothing came for long, or the clock was set
        assert keeper.left_over() == []  # it is still recorded
        window.close()
        (left,) = keeper.left_over()
        keeper.open(opened(session, Wish(left.path, left_over=True)))
    finally:
        keeper.close()
    np.testing.assert_allclose(session.document.take.weights, sent.weights, atol=1e-6)


def test_a_recording_is_not_lost_to_a_question(
    qtbot: QtBot, window: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    window.session.document.undo.resetClean()  # edits that are not saved
    recording(qtbot, window, Take(weights=demo.performance().weights[:20], fps=30.0))
    monkeypatch.setattr(QMessageBox, "question", lambda *_: QMessageBox.StandardButton.Cancel)
    before = window.session.document.take
    QTest.mouseClick(window.live.record_button, LEFT)
    assert window.session.document.take is before and window.notices.isVisible()
    (kept,) = window.keeper.folder.glob("*.partial.csv")
    assert len(read_take(kept)) == 20
    monkeypatch.setattr(QMessageBox, "question", lambda *_: QMessageBox.StandardButton.Discard)


def test_the_meter_shows_the_latency_of_the_picture(qtbot: QtBot, window: MainWindow) -> None:
    recording(qtbot, window, Take(weights=demo.performance().weights[:40], fps=30.0))
    qtbot.waitUntil(lambda: "on screen" in window.live.status.text(), timeout=10_000)
    assert all(0 < spent < 10_000 for spent in window.live._shown_ms)


def test_a_port_in_use_is_said_in_a_sentence(qtbot: QtBot, window: MainWindow) -> None:
    window.edits.live_tool()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        window.live.port.setValue(other.getsockname()[1])
        QTest.mouseClick(window.live.listen_button, LEFT)
    assert not window.live.listening
    assert window.notices.isVisible()
