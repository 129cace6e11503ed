"""How a take was read is said in a line, and each choice in it is changed by mouse and undone."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDropEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QComboBox, QFileDialog
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from engine.formats import livelink, read_take, write_take
from engine.formats.base.reading import Reading
from engine.formats.livelink.sides import exchange
from engine.take import SHAPE_INDEX, SHAPES, Take
from tests.films import film
from tests.journeys.conftest import load, noted, saved_as, settled

LEFT = Qt.MouseButton.LeftButton


def leaning(frames: int = 240, fps: float = 30.0) -> Take:
    """Return a mouth that goes to one side and the other, pulled by that side."""
    way = 0.4 * np.sin(np.linspace(0, 17, frames))
    weights = np.full((frames, len(SHAPES)), 0.2)
    for side, sign in (("Left", 1), ("Right", -1)):
        weights[:, SHAPE_INDEX[f"mouth{side}"]] = np.maximum(sign * way, 0)
        for shape in ("mouthDimple", "mouthStretch", "cheekSquint", "mouthUpperUp"):
            weights[:, SHAPE_INDEX[f"{shape}{side}"]] += 0.3 * sign * way
    return Take(weights, fps)


@pytest.fixture
def leaning_file(tmp_path: Path) -> Path:
    write_take(leaning(), tmp_path / "leaning.csv")
    return tmp_path / "leaning.csv"


def pick(qtbot: QtBot, box: QComboBox, index: int) -> None:
    """Open a list with the mouse and click one of its entries."""
    QTest.mouseClick(box, LEFT, pos=QPoint(box.width() - 10, box.height() // 2))
    view = box.view()
    qtbot.waitUntil(view.isVisible, timeout=5_000)
    view.scrollTo(box.model().index(index, 0))
    place = view.visualRect(box.model().index(index, 0)).center()
    with qtbot.waitSignal(box.activated, timeout=5_000):
        QTest.mouseMove(view.viewport(), place)
        QTest.mouseClick(view.viewport(), LEFT, pos=place)


def undone(qtbot: QtBot, window: MainWindow) -> None:
    steps = window.session.document.undo
    qtbot.waitUntil(lambda: window.actions_by_name["undo"].isEnabled() and window.isActiveWindow(), timeout=10_000)
    index = steps.index()
    QTest.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    qtbot.waitUntil(lambda: steps.index() == index - 1, timeout=10_000)


def dropped(window: MainWindow, path: Path) -> None:
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(path))])
    window.dropEvent(QDropEvent(QPointF(9, 9), Qt.DropAction.CopyAction, data, LEFT, Qt.KeyboardModifier.NoModifier))


def test_the_line_shows_rate_sides_and_reasons(qtbot: QtBot, window: MainWindow, leaning_file: Path) -> None:
    line = window.importing
    assert line.isHidden()  # the demo take is nobody's file
    load(qtbot, window, leaning_file)
    assert line.isVisible() and line.name.text() == "leaning.csv"
    assert (line.rate.currentText(), line.rate_reason.text()) == ("30 fps", "from timecodes")
    assert (line.sides.currentText(), line.sides_reason.text()) == ("automatic: as the app records", "sure")
    assert "sixtieths" in line.rate.toolTip() and "By the motion" in line.sides.toolTip()
    QTest.mouseClick(line.hide_button, LEFT)
    assert line.isHidden() and not window.actions_by_name["show_import"].isChecked()
    window.actions_by_name["show_import"].trigger()
    assert line.isVisible() and window.actions_by_name["show_import"].isChecked()


def test_the_rate_is_changed_by_mouse_and_undone(qtbot: QtBot, window: MainWindow, leaning_file: Path) -> None:
    load(qtbot, window, leaning_file)
    line, weights = window.importing, window.session.document.take.weights
    index = line.rate.findText("60")
    pick(qtbot, line.rate, index)
    assert window.session.document.take.fps == 60.0 and line.rate.currentText() == "60 fps"
    assert line.rate_reason.text() == "as asked" and "timecodes say 30" in line.rate.toolTip()
    assert window.status["rate"].text() == "60 fps" and window.session.document.undo.undoText() == "rate 60 fps"
    assert window.curves.hasFocus()
    np.testing.assert_array_equal(window.session.document.take.weights, weights)
    undone(qtbot, window)
    assert window.session.document.take.fps == 30.0 and line.rate.currentText() == "30 fps"
    assert window.status["rate"].text() == "30 fps" and line.rate_reason.text() == "from timecodes"
    window.session.document.undo.redo()
    pick(qtbot, line.rate, 0)  # automatic
    assert window.session.document.take.fps == 30.0 and window.session.document.undo.count() == 2


def test_the_rate_is_typed(qtbot: QtBot, window: MainWindow, leaning_file: Path) -> None:
    load(qtbot, window, leaning_file)
    box = window.importing.rate
    typed = box.lineEdit()
    for text, fps in (("29.97", 30000 / 1001), ("24 fps", 24.0), ("12,5", 12.5)):
        QTest.mouseDClick(typed, LEFT)
        typed.selectAll()
        QTest.keyClicks(typed, text)
        QTest.keyClick(typed, Qt.Key.Key_Return)
        assert window.session.document.take.fps == fps
    for text in ("fast", "0", "nan", "1e9"):
        steps = window.session.document.undo.count()
        typed.selectAll()
        QTest.keyClicks(typed, text)
        QTest.keyClick(typed, Qt.Key.Key_Return)
        assert window.session.document.take.fps == 12.5 and box.currentText() == "12.5 fps"
        assert window.notices.isVisible() and window.session.document.undo.count() == steps
        window.notices.hide()


def test_the_sides_are_changed_by_mouse_and_undone(qtbot: QtBot, window: MainWindow, leaning_file: Path) -> None:
    load(qtbot, window, leaning_file)
    line, before = window.importing, window.session.document.take.weights
    pick(qtbot, line.sides, 2)
    np.testing.assert_array_equal(window.session.document.take.weights, exchange(before))
    assert line.sides.currentText() == "as named" and "the motion says as the app records" in line.sides.toolTip()
    assert window.session.document.undo.undoText() == "sides as named"
    undone(qtbot, window)
    np.testing.assert_array_equal(window.session.document.take.weights, before)
    assert line.sides.currentText() == "automatic: as the app records"
    pick(qtbot, line.sides, 1)  # the same sides, by hand
    assert window.session.document.undo.undoText() == "sides as the app records"
    np.testing.assert_array_equal(window.session.document.take.weights, before)
    settled(qtbot, window)


def test_the_project_remembers_both(
    qtbot: QtBot, window: MainWindow, leaning_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    load(qtbot, window, leaning_file)
    noted(window, "before")
    pick(qtbot, window.importing.rate, window.importing.rate.findText("25"))
    pick(qtbot, window.importing.sides, 2)
    weights = window.session.document.take.weights
    saved_as(qtbot, window, tmp_path / "a.retake", monkeypatch)
    load(qtbot, window, leaning_file)
    assert window.session.document.take.fps == 30.0
    load(qtbot, window, tmp_path / "a.retake")
    assert window.session.document.take.fps == 25.0 and window.importing.isHidden()
    np.testing.assert_array_equal(window.session.document.take.weights, weights)
    window.actions_by_name["show_import"].trigger()
    assert window.importing.sides.currentText() == "as named" and window.importing.rate.currentText() == "25 fps"
    while window.session.document.undo.index() > 1:  # a choice by keys may pass another one, which is a step too
        undone(qtbot, window)
    assert window.session.document.take.fps == 30.0
    np.testing.assert_array_equal(window.session.document.take.weights, exchange(weights))


@pytest.mark.parametrize(("words", "sides"), [("", ""), ("as the app records", "recorded"), ("as named", "named")])
def test_the_export_asks_for_the_sides(
    qtbot: QtBot,
    window: MainWindow,
    leaning_file: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    words: str,
    sides: str,
) -> None:
    load(qtbot, window, leaning_file)
    out = tmp_path / "out.csv"

    def chosen(*given: object) -> tuple[str, str]:
        kinds = str(given[-1]).split(";;")
        return str(out), next(kind for kind in kinds if words in kind)

    monkeypatch.setattr(QFileDialog, "getSaveFileName", chosen)
    QTest.keyClick(window, Qt.Key.Key_E, Qt.KeyboardModifier.ControlModifier)
    if sides:
        read = read_take(out, reading=Reading(sides=sides))
        np.testing.assert_array_equal(read.weights, window.session.document.take.weights)
    assert (out.read_bytes() == leaning_file.read_bytes()) == (sides != "named")
    assert livelink.judged(read_take(out).origin).recorded == (sides != "named")


def handed_over(folder: Path) -> Path:
    folder.mkdir()
    write_take(leaning(fps=60.0), folder / "Slate_1_iPhone_raw.csv")
    write_take(leaning(fps=60.0), folder / "Slate_1_iPhone_cal.csv")
    film(folder / "Slate_1_iPhone.mov", range(0, 400, 40))
    (folder / "take.json").write_text(json.dumps({"videoTargetFrameRate": 60}))
    return folder


@pytest.mark.parametrize("file", ["", "take.json", "Slate_1_iPhone.mov", "Slate_1_iPhone_cal.csv", "zip"])
def test_any_part_of_a_take_that_is_dropped_opens_it_with_its_film(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, file: str
) -> None:
    monkeypatch.setattr("app.playback.packed.films_folder", lambda: tmp_path / "films")
    path = handed_over(tmp_path / "Slate_1")
    if file == "zip":
        with zipfile.ZipFile(tmp_path / "Slate_1.zip", "w") as archive:
            for each in path.iterdir():
                archive.write(each, f"Slate_1/{each.name}")
        path = tmp_path / "Slate_1.zip"
    with qtbot.waitSignal(window.files.opened, timeout=20_000):
        dropped(window, path / file if file != "zip" else path)
    qtbot.waitUntil(lambda: window.session.document.video is not None, timeout=20_000)
    assert window.session.document.take.name == "Slate_1_iPhone_cal.csv" and window.importing.isVisible()
    assert "calibrated" in window.importing.notices.toolTip()
    assert window.session.document.video.suffix == ".mov"
    assert not window.notices.isVisible()  # that its film is silent is no fault


def test_a_folder_is_chosen_in_a_dialog(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = handed_over(tmp_path / "Slate_1")
    monkeypatch.setattr(QFileDialog, "getExistingDirectory", lambda *_: str(folder))
    with qtbot.waitSignal(window.files.opened, timeout=20_000):
        window.actions_by_name["open_folder"].trigger()
    assert window.session.document.path == folder / "Slate_1_iPhone_cal.csv"
