from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.widgets.section import CountBox


def test_a_box_names_one_and_many(qtbot: QtBot) -> None:
    box = CountBox("frame", lowest=0, highest=50)
    qtbot.addWidget(box)
    assert box.text() == "0 frames"
    with QSignalBlocker(box):
        box.setValue(1)
    assert box.text() == "1 frame"
    QTest.keyClick(box, Qt.Key.Key_Up)
    assert (box.text(), box.value()) == ("2 frames", 2)
    box.selectAll()
    QTest.keyClicks(box, "1")
    assert (box.text(), box.value()) == ("1 frame", 1)
