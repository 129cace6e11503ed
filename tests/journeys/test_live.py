"""A phone's stream: listened to, shown, recorded and opened."""

from __future__ import annotations

import socket
import threading

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.main_window import MainWindow
from engine.live.replay import replay
from engine.performance import demo
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
    sender.join(timeout=20)
    qtbot.waitUntil(lambda: window.live._recorder is not None and len(window.live._recorder) >= 45, timeout=10_000)
    QTest.mouseClick(window.live.record_button, LEFT)
    assert len(window.session.take) == 45 and window.session.take.name == "live"
    np.testing.assert_allclose(window.session.take.weights, sent.weights, atol=1e-6)
    QTest.mouseClick(window.live.listen_button, LEFT)
    assert not window.live.listening


def test_a_port_in_use_is_said_in_a_sentence(qtbot: QtBot, window: MainWindow) -> None:
    window.edits.live_tool()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        window.live.port.setValue(other.getsockname()[1])
        QTest.mouseClick(window.live.listen_button, LEFT)
    assert not window.live.listening
    assert window.notices.isVisible()
