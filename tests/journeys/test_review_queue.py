"""A folder of pairs is judged one after another, put away and taken up again; what cannot be shown loses nothing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from engine.formats import read_take, write_take
from engine.lab.performer import demo
from engine.lab.performer.performer import Script, perform
from engine.project import Project, peek, replay
from engine.review.align import on_clock_of
from engine.review.queue import FOLDER
from engine.take import SHAPE_INDEX, Take
from tests.journeys.conftest import load, saved_as, settled
from tests.journeys.test_review_notes import press, types

Key = Qt.Key
CONTROL, SHIFT, ALT = (
    Qt.KeyboardModifier.ControlModifier,
    Qt.KeyboardModifier.ShiftModifier,
    Qt.KeyboardModifier.AltModifier,
)
DEMO = read_take(demo.BUNDLED)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    pairs = tmp_path / "pairs"
    for name in ("before", "after"):
        (pairs / name).mkdir(parents=True)
    for number in range(5):
        weights = DEMO.weights.copy()
        weights[60:80, SHAPE_INDEX["jawOpen"]] += 0.1 * (number + 1)
        write_take(DEMO, pairs / "before" / f"shot{number}.csv")
        write_take(DEMO.with_weights(weights), pairs / "after" / f"shot{number}.csv")
    return pairs


def opened(qtbot: QtBot, window: MainWindow, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(QFileDialog, "getExistingDirectory", lambda *_: str(folder))
    press(window, Key.Key_O, CONTROL | SHIFT)
    qtbot.waitUntil(lambda: window.review.queueing.current is not None, timeout=30_000)
    shown(qtbot, window)


def shown(qtbot: QtBot, window: MainWindow, place: int | None = None) -> None:
    queueing = window.review.queueing
    qtbot.waitUntil(lambda: place is None or queueing.current == place, timeout=30_000)
    qtbot.waitUntil(lambda: bool(window.review.section.changes) and window.review.comparing.idle, timeout=30_000)
    window.curves.setFocus()


def test_a_queue_of_five_is_judged_by_keyboard_and_taken_up_where_it_was_left(
    qtbot: QtBot, window: MainWindow, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window.settings.author = "Ana"
    opened(qtbot, window, folder, monkeypatch)
    queueing, document = window.review.queueing, window.session.document
    assert queueing.current == 0 and window.review.queue.bar.text() == "0 of 5 judged"
    assert [(change.start, change.stop) for change in window.review.section.changes] == [(60, 80)]
    press(window, Key.Key_A, CONTROL | SHIFT)
    press(window, Key.Key_PageDown, CONTROL)
    shown(qtbot, window, 1)
    press(window, Key.Key_Down, ALT)
    press(window, Key.Key_N)
    types("pops")
    press(window, Key.Key_W, CONTROL | SHIFT)
    types("ease the jaw in")
    press(window, Key.Key_PageDown, CONTROL)
    shown(qtbot, window, 2)
    press(window, Key.Key_A, CONTROL | SHIFT)
    assert window.review.queue.bar.text() == "3 of 5 judged"
    assert [window.review.queue.list.item(row).text()[0] for row in range(5)] == ["✓", "!", "✓", "○", "○"]
    press(window, Key.Key_PageUp, CONTROL)
    shown(qtbot, window, 1)
    assert document.marks.verdict == "Needs work: ease the jaw in" and document.marks.notes[0].frames == 20
    settled(qtbot, window)

    load(qtbot, window, demo.BUNDLED)  # which lets go of the review, as the end of the program does
    opened(qtbot, window, folder, monkeypatch)  # all of it is read anew from the folder
    shown(qtbot, window, 3)
    assert window.review.queue.bar.text() == "3 of 5 judged"
    told = peek(folder / FOLDER / "shot1.retake").verdict
    assert told is not None and (told.judgement, told.why, told.author) == ("Needs work", "ease the jaw in", "Ana")
    settled(qtbot, window)


def test_a_pair_that_cannot_be_read_is_a_sentence_and_the_rest_goes_on(
    qtbot: QtBot, window: MainWindow, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "after" / "shot1.csv").write_text("x")
    other = perform(Script(phones=("SIL", "AA1", "T", "IY1", "SIL") * 6, seed=3), name="other")
    write_take(Take(other.weights, other.fps, name="other"), folder / "after" / "shot2.csv")
    opened(qtbot, window, folder, monkeypatch)
    window.review.verdict.judge("Approved")
    press(window, Key.Key_PageDown, CONTROL)
    qtbot.waitUntil(lambda: bool(window.review.queueing.queue[1].trouble), timeout=30_000)
    told = window.notices.text.text()
    assert window.notices.isVisible() and "shot1.csv" in told and "Traceback" not in told
    assert window.review.queueing.current == 0 and window.session.document.marks.verdict == "Approved"
    window.review.queueing.go_to(2)  # another person's: shown all the same, and how much alike both move is told
    shown(qtbot, window, 2)
    assert "Both move alike by 0." in window.review.section.alignment.text()
    assert window.review.queue.bar.text() == "1 of 5 judged"
    settled(qtbot, window)


def test_a_folder_without_pairs_is_a_sentence(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "empty").mkdir()
    monkeypatch.setattr(QFileDialog, "getExistingDirectory", lambda *_: str(tmp_path / "empty"))
    with qtbot.waitSignal(window.review.failed, timeout=20_000) as caught:
        window.actions_by_name["open_queue"].trigger()
    assert "no pairs" in caught.args[0] and window.session.document.undo.count() == 0
    settled(qtbot, window)


def test_the_take_before_is_moved_by_hand_and_back_and_stays_where_it_was_put(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    document, box = window.session.document, window.review.section.offset
    part = DEMO.weights[30:230].copy()
    write_take(Take(part, DEMO.fps, name="part.csv"), tmp_path / "part.csv")
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(tmp_path / "part.csv"), ""))
    with qtbot.waitSignal(window.review.comparing.paired, timeout=20_000):
        window.actions_by_name["compare_take"].trigger()
    qtbot.waitUntil(lambda: len(document.take) == 200 and box.value() == 30.0, timeout=20_000)
    assert not window.review.section._offset_row.isHidden()
    window.curves.setFocus()
    press(window, Key.Key_Right, CONTROL | ALT)
    qtbot.waitUntil(lambda: box.value() == 31.0, timeout=20_000)
    expected, common = on_clock_of(document.take, DEMO, 31 / DEMO.fps)
    np.testing.assert_allclose(document.original.weights[common], expected[common], atol=1e-9)
    np.testing.assert_array_equal(document.take.weights, read_take(tmp_path / "part.csv").weights)
    qtbot.waitUntil(lambda: bool(window.review.section.changes), timeout=20_000)  # a frame off, both differ everywhere
    press(window, Key.Key_Z, CONTROL)
    qtbot.waitUntil(lambda: not window.review.section.changes, timeout=20_000)
    assert box.value() == 30.0
    box.setFocus()
    box.selectAll()
    QTest.keyClicks(box, "-4")
    QTest.keyClick(box, Key.Key_Return)
    qtbot.waitUntil(lambda: document.undo.undoText() == "align at -4 frames", timeout=20_000)
    saved_as(qtbot, window, tmp_path / "moved.retake", monkeypatch)
    held = document.original.weights.copy()
    state = replay(Project.open(tmp_path / "moved.retake", read_only=True).contents)
    assert state.original is not None
    np.testing.assert_array_equal(state.original.weights, held)
    load(qtbot, window, demo.BUNDLED)
    load(qtbot, window, tmp_path / "moved.retake")
    np.testing.assert_array_equal(document.original.weights, held)
    assert box.value() == -4.0
    press(window, Key.Key_Z, CONTROL)
    assert box.value() == 30.0
    press(window, Key.Key_Right, CONTROL | ALT)  # the file that it came from is not known here
    assert "not where it was" in window.notices.text.text()
    settled(qtbot, window)


def test_an_offset_without_a_common_frame_is_a_sentence_and_nothing_moves(
    qtbot: QtBot, window: MainWindow, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened(qtbot, window, folder, monkeypatch)
    before = window.session.document.original
    with qtbot.waitSignal(window.review.failed, timeout=20_000) as caught:
        window.review.section.offset.setValue(5000.0)
    assert "no frame in common" in caught.args[0] and window.session.document.original is before
    assert window.review.section.offset.value() == 0.0
    settled(qtbot, window)
