"""Whatever files, packets and reviewers call things, every widget of the window shows it as plain, short text."""

from __future__ import annotations

import re
import socket
import threading
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtGui import QAction, QContextMenuEvent, QHelpEvent, QKeySequence
from PySide6.QtWidgets import (
    QAbstractButton,
    QApplication,
    QComboBox,
    QLabel,
    QLineEdit,
    QListWidget,
    QMenu,
    QMessageBox,
    QToolTip,
    QWidget,
)
from pytestqt.qtbot import QtBot
from shiboken6 import isValid

from app.window.main_window import MainWindow
from engine import project
from engine.character import bundled, save
from engine.formats import write_take
from engine.lab.performer import demo
from engine.live.replay import replay
from engine.project import Contents, Edit, Marks, Media, Note, Pin, Span
from engine.take import Take
from tests.engine.project.projects import an_edit
from tests.journeys.conftest import load, settled

UNSAFE = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")
WIDEST_PX, LONGEST = 1280, 2200  # places to break long words at count too
HOSTILE = {
    "picture": "<img src=/dev/zero>",
    "bold": "<b>bold</b> & <a href='file:///'>link</a>",
    "mnemonic": "&File &&amp; R&D",
    "control codes": "a\x1b[31m\x07\x00\x85b\tc\r\nd",
    "turned": "photo\u202egpj.exe\u2066",
    "long": "W" * 10_000,
    "accents": "e" + "\u0301" * 5_000,
    "title mark": "[*] %1 {0}",
}


def all_widgets(window: MainWindow) -> Iterator[QWidget]:
    yield window
    yield from window.findChildren(QWidget)
    yield from (each for each in QApplication.topLevelWidgets() if each is not window and each.isVisible())


def texts_of(widget: QWidget) -> Iterator[str]:
    """Yield each text that a widget shows of itself; what is typed into a line is the user's own."""
    yield from (widget.windowTitle(), widget.toolTip(), widget.statusTip(), widget.accessibleName())
    if isinstance(widget, (QLabel, QAbstractButton)):
        yield widget.text()
    if isinstance(widget, QComboBox):
        yield from (widget.itemText(index) for index in range(widget.count()))
    if isinstance(widget, QListWidget):
        for row in range(widget.count()):
            yield from (widget.item(row).text(), widget.item(row).toolTip())
    if isinstance(widget, QLineEdit):
        yield widget.placeholderText()
    if isinstance(widget, QMenu):
        yield widget.title()


def check(window: MainWindow) -> None:
    """Assert that nothing on screen is markup, steers the screen, makes a shortcut, or is endless."""
    for widget in all_widgets(window):
        if isinstance(widget, QLabel):
            assert widget.textFormat() == Qt.TextFormat.PlainText or not widget.text(), widget
        if isinstance(widget, QAbstractButton):
            assert QKeySequence.mnemonic(widget.text()).isEmpty(), widget.text()
        for text in texts_of(widget):
            assert not UNSAFE.search(text) and len(text) <= LONGEST, (widget, text[:80])
    for action in window.findChildren(QAction):
        if not isinstance(action.parent(), QLineEdit):
            assert QKeySequence.mnemonic(action.text()).isEmpty(), action.text()
            assert not UNSAFE.search(action.text() + action.toolTip()) and len(action.text()) <= 200
    assert window.minimumSizeHint().width() <= WIDEST_PX
    for widget in window.findChildren(QWidget):
        if isValid(widget) and widget.isVisible() and widget.toolTip():  # an earlier tooltip is gone
            show_tip(widget)
    QToolTip.hideText()
    window.repaint()


def show_tip(widget: QWidget) -> None:
    at = QPoint(2, 2)
    QApplication.sendEvent(widget, QHelpEvent(QEvent.Type.ToolTip, at, widget.mapToGlobal(at)))
    for each in QApplication.topLevelWidgets():
        if each.objectName() == "qtooltip_label" and isinstance(each, QLabel):
            assert each.textFormat() == Qt.TextFormat.PlainText


def as_file_name(text: str) -> str:
    return re.sub("[/\x00]", "_", text)[:60].encode("utf-8", "ignore")[:180].decode("utf-8", "ignore")


def hostile_contents(text: str) -> Contents:
    take = replace(demo.performance(), name=text)
    stored = text.replace("\x00", "")
    marks = Marks(
        spans=(Span(20, 50, stored), Span(60, 90, "lower", stored)),
        pins=(Pin(30, {"jawOpen": 0.2}, 20, 40),),
        notes=(Note(0, stored, stored, stored), Note(25, "Ana", "2025-01-02T03:04:05Z", stored)),
        media=(Media("audio", f"{as_file_name(stored)}.wav", "0" * 64),),
    )
    edit = an_edit(take, 1)
    return Contents(take, (Edit("drag", stored, edit.start, edit.weights, edit.asked),), 1, marks)


@pytest.mark.parametrize("kind", list(HOSTILE))
def test_a_project_names_things_in_plain_text(qtbot: QtBot, window: MainWindow, tmp_path: Path, kind: str) -> None:
    text = HOSTILE[kind]
    path = tmp_path / f"{as_file_name(text)}.retake"
    project.create(path, hostile_contents(text)).close()
    load(qtbot, window, path)
    settled(qtbot, window)
    window.session.view.select((20, 50))
    qtbot.waitUntil(window.missing.isVisible)
    window.notices.warn(f"{path.name} {text}", text)
    window.status.show_message(text)
    window.media.device_changed.emit()
    check(window)
    window.menus._fill_recent()
    window.marks.edit_note()
    for lane in ("notes", "spans", "flags", "pins"):
        at = QPoint(round(window.timeline.x_of(25)), round(window.timeline.lane_box(lane).center().y()))
        assert not UNSAFE.search(window.timeline.told_at(at.toPointF())) or lane == "notes"
        QApplication.sendEvent(
            window.timeline, QContextMenuEvent(QContextMenuEvent.Reason.Mouse, at, window.timeline.mapToGlobal(at))
        )
        check(window)
        if window._contexts.menu is not None:
            window._contexts.menu.close()
            qtbot.waitUntil(lambda: window._contexts.menu is None)


@pytest.mark.parametrize("kind", list(HOSTILE))
def test_questions_and_other_files_do_too(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = HOSTILE[kind]
    name = as_file_name(text)
    asked: list[tuple[str, ...]] = []
    answer = QMessageBox.StandardButton.Cancel
    monkeypatch.setattr(QMessageBox, "question", lambda *words: asked.append(words[1:3]) or answer)
    take = tmp_path / f"{name}.csv"
    write_take(demo.performance(), take)
    load(qtbot, window, take)
    head = tmp_path / f"{name}.npz"
    save(replace(bundled(), name=text), head)
    window.retarget.retarget_tool()
    window.retarget.retargeting.choosing.choose_target(head)
    qtbot.waitUntil(lambda: window.retarget.retargeting.target.head is not None, timeout=20_000)
    said = tmp_path / f"{name}.tsv"
    said.write_bytes(f"0.0\tA\n1.0\t{text.split(chr(10))[0][:50]}\n2.0\tX\n".encode("utf-8", "ignore"))
    window.visemes.attach(said)
    qtbot.wait(200)
    window.session.document.undo.resetClean()
    window.load(demo.BUNDLED)
    assert asked and not any(UNSAFE.search(each) or len(each) > 300 for words in asked for each in words)
    check(window)
    settled(qtbot, window)


def test_a_sender_names_itself_in_plain_text_and_can_still_be_chosen(qtbot: QtBot, window: MainWindow) -> None:
    name = "<b>&\u202e\x1b[31mphone"
    window.edits.live_tool()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    window.live.port.setValue(port)
    window.live.toggle()
    sent = Take(weights=demo.performance().weights[:10], fps=30.0)
    sender = threading.Thread(target=replay, args=(sent, ("127.0.0.1", port)), kwargs={"subject": name})
    sender.start()
    qtbot.waitUntil(lambda: window.live.subjects.count() == 1, timeout=20_000)
    sender.join()
    check(window)
    assert window.live.subjects.itemText(0).startswith("<b>&") and window.live.subjects.itemData(0) == name
    window.live._choose_subject(0)
    window.live.stop()
