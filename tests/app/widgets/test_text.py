"""Widgets show text as it is: the program's own labels, and those that Qt builds for tooltips and questions."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
from PySide6.QtCore import QEvent, QObject, QPoint, Qt
from PySide6.QtGui import QHelpEvent, QKeySequence
from PySide6.QtWidgets import QApplication, QLabel, QMessageBox, QPushButton, QToolTip
from pytestqt.qtbot import QtBot

from app.widgets.text import CAPTION_LENGTH, TIP_LENGTH, TIP_WIDTH, Label, Name, PlainText, caption, tip, title

APP = Path(__file__).parents[3] / "app"
MARKUP = "<img src=/dev/zero><b>x</b> & \x1b[31m \u202egpj"


@pytest.fixture
def guard(qapp: QApplication) -> object:
    parent = QObject()
    guarding = PlainText(parent)
    yield guarding
    guarding.remove()


def test_labels_show_markup_as_text(qtbot: QtBot) -> None:
    label = Label(MARKUP)
    qtbot.addWidget(label)
    assert label.textFormat() == Qt.TextFormat.PlainText
    assert "<b>x</b>" in label.text() and "\x1b" not in label.text() and "\u202e" not in label.text()


def test_endless_words_do_not_widen_a_label_that_wraps(qtbot: QtBot) -> None:
    label = Label("a" * 10_000)
    label.setWordWrap(True)
    qtbot.addWidget(label)
    assert label.minimumSizeHint().width() < 500


def test_names_are_shortened_and_shown_whole_in_the_tooltip(qtbot: QtBot) -> None:
    name = Name("<b>" + "x" * 100 + ".csv", longest=30)
    qtbot.addWidget(name)
    assert len(name.text()) <= 30 and name.text().endswith(".csv") and "<b>" in name.toolTip().replace("\n", "")
    name.setText("short")
    assert name.text() == "short" and name.toolTip() == ""


def test_captions_make_no_shortcuts_and_stay_in_one_line(qtbot: QtBot) -> None:
    button = QPushButton(caption("R&D\tCtrl+X\nnext"))
    qtbot.addWidget(button)
    assert button.text() == "R&&D Ctrl+X next" and button.shortcut() == QKeySequence()
    assert len(caption("x" * 10_000)) <= CAPTION_LENGTH


def test_tooltips_are_neither_wide_nor_endless() -> None:
    lines = tip("a" * 10_000 + "\n" + "b " * 10_000).split("\n")
    assert max(map(len, lines)) <= TIP_WIDTH and sum(map(len, lines)) <= TIP_LENGTH


def test_a_title_has_no_mark_of_its_own() -> None:
    assert title("a[*]b") == "a[*][*]b"


def test_tooltips_of_any_widget_are_plain(qtbot: QtBot, guard: object) -> None:
    button = QPushButton("x")
    qtbot.addWidget(button)
    button.setToolTip("<b>bold</b>")
    button.show()
    where = button.mapToGlobal(QPoint(2, 2))
    QApplication.sendEvent(button, QHelpEvent(QEvent.Type.ToolTip, QPoint(2, 2), where))
    (shown,) = [each for each in QApplication.topLevelWidgets() if each.objectName() == "qtooltip_label"]
    assert isinstance(shown, QLabel) and shown.isVisible() and shown.textFormat() == Qt.TextFormat.PlainText
    assert shown.text() == "<b>bold</b>"
    QToolTip.hideText()
    qtbot.waitUntil(lambda: not QToolTip.isVisible())


def test_questions_are_plain_before_they_are_seen(qtbot: QtBot, guard: object) -> None:
    box = QMessageBox()
    qtbot.addWidget(box)
    box.setText("<b>bold</b>")
    box.setInformativeText("<i>more</i>")
    box.sizeHint()
    labels = [label for label in box.findChildren(QLabel) if label.text()]
    assert len(labels) == 2 and all(label.textFormat() == Qt.TextFormat.PlainText for label in labels)


def test_every_label_of_the_program_is_one_of_ours() -> None:
    allowed = {APP / "widgets" / "text.py", APP / "dialogs" / "page.py"}
    found = [
        f"{path.relative_to(APP)}:{node.lineno}"
        for path in APP.rglob("*.py")
        if path not in allowed
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and ast.unparse(node.func).rpartition(".")[2] in ("QLabel", "setTextFormat")
    ]
    assert found == []
