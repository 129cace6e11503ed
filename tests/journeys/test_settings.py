"""Settings apply at once, beside the work, and are there at the next start."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QComboBox
from pytestqt.qtbot import QtBot

from app import theme
from app.bench.playback import NullSink
from app.dialogs.page import Page
from app.dialogs.settings import SettingsDialog
from app.playback import device
from app.playback.clock import AudioClock
from app.settings import Settings, log_path
from app.window.main_window import MainWindow
from engine.formats.audio import Audio
from tests.journeys.conftest import noted

CONTROL = Qt.KeyboardModifier.ControlModifier


@pytest.fixture
def dialog(qtbot: QtBot, window: MainWindow, monkeypatch: pytest.MonkeyPatch) -> SettingsDialog:
    monkeypatch.setattr(device, "names", lambda: ["Built-in", "Headset"])
    QTest.keyClick(window, Qt.Key.Key_Comma, CONTROL)
    opened: SettingsDialog = window.preferences._dialog
    assert opened.isVisible() and not opened.isModal()
    qtbot.waitUntil(lambda: opened.speaker.count() == 3, timeout=10_000)
    return opened


def pick(box: QComboBox, text: str) -> None:
    """Type what to choose, as one can in a list."""
    QTest.keyClicks(box, text)
    assert box.currentText() == text


def test_each_setting_applies_at_once_and_is_kept(
    qtbot: QtBot, window: MainWindow, dialog: SettingsDialog, tmp_path: Path
) -> None:
    kept = Settings(tmp_path / "settings.ini")
    pick(dialog.theme, "Light")
    assert window.colours is theme.LIGHT and window.actions_by_name["light_theme"].isChecked()
    window.actions_by_name["light_theme"].trigger()
    assert window.colours is theme.DARK
    pick(dialog.count, "Frames")
    window.session.view.move_playhead(70)
    assert window.timeline.in_frames and window.status["place"].text() == "frame 70"
    pick(dialog.preset, "Maya")
    assert window.actions_by_name["drag_tool"].shortcut().toString() == "W"
    dialog.author.selectAll()
    QTest.keyClicks(dialog.author, "Ana")
    QTest.keyClick(dialog.author, Qt.Key.Key_Return)
    noted(window, "softer")
    assert window.session.document.marks.notes[0].author == "Ana"
    window.settings.remember(tmp_path / "a.csv")
    dialog.refresh()
    assert dialog.recent.text() == "1 file is remembered."
    QTest.mouseClick(dialog.clear, Qt.MouseButton.LeftButton)
    window.settings._stored.sync()
    assert window.settings.recent == [] and not dialog.clear.isEnabled()
    assert (kept.theme, kept.count, kept.preset, kept.author) == ("dark", "frames", "Maya", "Ana")


def test_the_loudspeaker_and_scrubbing_are_chosen_while_a_take_is_open(
    qtbot: QtBot, window: MainWindow, dialog: SettingsDialog, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []

    class Named(NullSink):
        def __init__(self, rate: int, channels: int, *, wanted: str = "") -> None:
            super().__init__(rate, channels)
            self.name = wanted or "Built-in"
            opened.append(self.name)

    monkeypatch.setattr("app.playback.media.open_device", Named)
    assert dialog.playing.text() == "No sound is attached to this take."
    window.media.use_device("")
    window.session.document.attach_audio(Audio(np.zeros(48_000, np.float32), 48_000))
    pick(dialog.speaker, "Headset")
    assert opened[-1] == "Headset" and dialog.playing.text() == "Playing on Headset."
    assert window.status["sound"].text() == "♪ Headset"
    clock = window.transport.clock
    assert isinstance(clock, AudioClock) and clock.scrubs
    QTest.mouseClick(dialog.scrubs, Qt.MouseButton.LeftButton, pos=QPoint(10, dialog.scrubs.height() // 2))
    assert not clock.scrubs and not window.settings.scrubs
    window.session.view.move_playhead(30)
    assert clock._sink._thread is None  # nothing was heard


def test_a_settings_file_with_nonsense_is_as_good_as_none(tmp_path: Path) -> None:
    (tmp_path / "s.ini").write_text('[General]\ntheme=7\npreset=\ncount=@ByteArray(x)\nplaces="[1"\nrecent=\n')
    settings = Settings(tmp_path / "s.ini")
    assert (settings.theme, settings.preset, settings.count) == ("dark", "Retake", "timecode")
    assert settings.place_of("0" * 64) is None and settings.recent == []
    settings.remember_place("0" * 64, tmp_path / "Ärger 顔.wav")
    assert settings.place_of("0" * 64) == tmp_path / "Ärger 顔.wav"


def test_about_says_the_versions_and_where_the_log_is(qtbot: QtBot, window: MainWindow) -> None:
    window.actions_by_name["about"].trigger()
    (box,) = [each for each in QApplication.topLevelWidgets() if isinstance(each, Page) and each.isVisible()]
    assert str(log_path()) in box.text.text() and "PySide6" in box.text.text() and not box.isModal()
    box.close()
