"""Sound and reference video beside a take: found on opening, seen, played, muted, and gone with the take."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import soundfile
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.bench.playback import NullSink
from app.playback.clock import AudioClock
from app.window.main_window import MainWindow
from engine.lab.performer import demo
from tests.films import film, shade
from tests.journeys.conftest import load, settled


def test_what_lies_beside_a_take_is_heard_and_seen(qtbot: QtBot, window: MainWindow, tmp_path: Path) -> None:
    window.media._open_sink = NullSink
    take = Path(shutil.copy(demo.BUNDLED, tmp_path / "slate.csv"))
    soundfile.write(tmp_path / "slate.wav", np.random.default_rng(0).uniform(-0.5, 0.5, 16_000 * 10), 16_000)
    film(tmp_path / "slate.mp4", [round(1000 * n / 30) for n in range(300)])
    low = window.timeline.height()
    load(qtbot, window, take)
    qtbot.waitUntil(lambda: window.session.document.audio is not None, timeout=10_000)
    qtbot.waitUntil(lambda: window.timeline.height() > low, timeout=10_000)
    assert window.reference.isVisible() and isinstance(window.transport.clock, AudioClock)

    x = round(window.timeline.x_of(60))
    QTest.mouseClick(window.timeline, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, QPoint(x, 45))
    settled(qtbot, window)
    qtbot.waitUntil(lambda: not window.reference.shown.image.isNull() and window.reference.reading.idle, timeout=10_000)
    qtbot.wait(20)
    assert abs(window.session.view.playhead - 60) <= 1
    assert abs(window.reference.shown.image.pixelColor(5, 5).green() - shade(window.session.view.playhead)) <= 3

    QTest.keyClick(window, Qt.Key.Key_Space)
    qtbot.waitUntil(lambda: window.session.view.playhead > 75, timeout=10_000)
    QTest.keyClick(window, Qt.Key.Key_M, Qt.KeyboardModifier.ControlModifier)
    assert window.transport.clock.muted and window.transport.playing
    QTest.keyClick(window, Qt.Key.Key_Space)

    load(qtbot, window, demo.BUNDLED)
    assert window.session.document.audio is None and not window.reference.isVisible()
    qtbot.waitUntil(lambda: window.timeline.height() == low, timeout=10_000)
