"""Notices go when they were read, or at once by Escape or their button; what endangers the work stays."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPointF, Qt
from PySide6.QtGui import QEnterEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QFileDialog
from pytestqt.qtbot import QtBot

from app.dialogs.keys import KeysDialog
from app.theme import DARK
from app.window.main_window import MainWindow
from app.window.notices import READ_MS, SHOWN_MS
from engine.formats import read_take
from engine.formats.audio import Audio
from engine.project import Span
from tests.journeys.conftest import noted


def test_escape_puts_a_notice_away_before_the_selection(window: MainWindow) -> None:
    window.session.view.select((10, 20))
    window.notices.warn("take.csv is not a take.", "Export it again.")
    QTest.keyClick(window.curves, Qt.Key.Key_Escape)
    assert not window.notices.isVisible() and window.session.view.selection == (10, 20)
    QTest.keyClick(window.curves, Qt.Key.Key_Escape)
    assert window.session.view.selection is None


def test_the_button_puts_it_away(window: MainWindow) -> None:
    window.notices.warn_until_solved("The disk is full.")
    QTest.mouseClick(window.notices.dismiss, Qt.MouseButton.LeftButton)
    assert not window.notices.isVisible()


def test_a_notice_goes_when_it_was_read_but_not_under_the_pointer(qtbot: QtBot, window: MainWindow) -> None:
    notices = window.notices
    notices.warn("take.csv is not a take.")
    assert notices.fading.isActive()
    assert notices.fading.interval() == SHOWN_MS + READ_MS * len(notices.text.text())
    at = QPointF(3, 3)
    QApplication.sendEvent(notices, QEnterEvent(at, at, at))
    assert not notices.fading.isActive()
    QApplication.sendEvent(notices, QEvent(QEvent.Type.Leave))
    assert notices.fading.isActive()
    notices.fading.setInterval(1)
    qtbot.waitUntil(lambda: not notices.isVisible())


def test_a_warning_about_unsafe_work_stays_until_it_is_safe(window: MainWindow) -> None:
    window.keeper.failed.emit("demo.retake could not be written.", "Free some space.")
    assert window.notices.isVisible() and not window.notices.fading.isActive()
    window.keeper.mended.emit("demo.retake could not be written.")
    assert not window.notices.isVisible()


def test_an_export_says_what_it_wrote_and_what_is_not_in_it(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "out.csv"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, **__: (str(path), ""))
    assert window.files.export()
    assert window.notices.text.text() == "Wrote out.csv: 322 frames at 30 fps, 00:00:10:22."
    noted(window, "late")
    window.session.document.set_marks(
        replace(window.session.document.marks, spans=(*window.session.document.marks.spans, Span(3, 9)))
    )
    assert window.files.export() and len(read_take(path)) == 322
    told = window.notices.text.text()
    assert told.endswith(
        "A take's file cannot hold 1 note, 1 marked span or 1 step to undo. Save the project to keep all of it."
    )
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, **__: (str(tmp_path / "kept.retake"), ""))
    assert window.files.save()
    qtbot.waitUntil(lambda: not window.session.document.edited)
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, **__: (str(path), ""))
    assert window.files.export()
    assert window.notices.text.text() == "Wrote out.csv: 322 frames at 30 fps, 00:00:10:22."


def test_sound_that_goes_on_after_the_take_is_said(qtbot: QtBot, window: MainWindow) -> None:
    rate, length_s = 8000, window.session.document.take.duration_s
    longer = Audio(np.zeros(round(rate * (length_s + 2.0)), np.float32), rate)
    window.session.document.attach_audio(longer)
    told = "The sound goes on 2.0 s after the take's end; that is not heard."
    assert window.status["notice"].text() == told
    window.session.document.slide("audio", -1.0)
    assert window.session.document.offset_s("audio") == -1.0
    fitting = Audio(np.zeros(round(rate * length_s), np.float32), rate)
    window.status.show_message("")
    window.session.document.slide("audio", None)
    window.session.document.attach_audio(fitting)
    assert window.status["notice"].text() == ""


def test_a_key_that_is_changed_counts_at_once(qtbot: QtBot, window: MainWindow) -> None:
    window.preferences.edit_keys()
    dialog = window.findChild(KeysDialog)
    assert isinstance(dialog, KeysDialog)
    dialog.table.setCurrentCell([row.name for row in dialog._rows].index("mark_tool"), 0)
    QTest.keyClick(dialog.entry, Qt.Key.Key_F6)
    dialog.close()
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow)
    QTest.keyClick(window.curves, Qt.Key.Key_F6)
    assert window.session.view.tool == "mark"
    window.menus.use_preset("Maya")
    assert window.actions_by_name["mark_tool"].shortcut().toString() == "F6"


def test_lists_that_drop_down_have_no_light_bars(qtbot: QtBot, window: MainWindow) -> None:
    box = window.preview.presets
    box.showPopup()
    shown = box.view().window()
    qtbot.waitUntil(shown.isVisible)
    image = shown.grab().toImage()
    edges = [
        image.pixelColor(x, y) for x in range(image.width()) for y in (0, 1, image.height() - 2, image.height() - 1)
    ]
    assert max(colour.lightness() for colour in edges) < 128, DARK.panel
    box.hidePopup()
