"""Who checks other people's work: go through what was changed by keyboard alone, judge, compare two takes, write a report."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from engine import project
from engine.formats import read_take, write_take
from engine.lab.performer import demo
from engine.take import SHAPE_INDEX, Take
from tests.journeys.conftest import load, saved_as, settled

JAW = SHAPE_INDEX["jawOpen"]
CONTROL, SHIFT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier


def edited(path: Path, *ranges: tuple[int, int]) -> Path:
    take = read_take(demo.BUNDLED)
    weights = take.weights.copy()
    for start, stop in ranges:
        weights[start:stop, JAW] += 0.3
    write_take(take.with_weights(weights), path)
    return path


def compared(qtbot: QtBot, window: MainWindow, path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(path), ""))
    with qtbot.waitSignal(window.review.comparing.paired, timeout=20_000):
        window.actions_by_name["compare_take"].trigger()
    qtbot.waitUntil(lambda: bool(window.review.section.changes), timeout=20_000)


def test_changes_are_gone_through_judged_and_saved_by_keyboard_alone(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = window.session
    compared(qtbot, window, edited(tmp_path / "b.csv", (60, 80), (150, 160)), monkeypatch)
    assert session.view.tool == "review" and session.document.undo.count() == 1
    assert [(change.start, change.stop) for change in window.review.section.changes] == [(60, 80), (150, 160)]
    assert session.document.differences == ((60, 80), (150, 160))

    session.view.move_playhead(0)
    QTest.keyClick(window, Qt.Key.Key_Down, Qt.KeyboardModifier.AltModifier)
    assert 60 <= session.view.playhead < 80 and session.view.selection == (60, 80)
    QTest.keyClick(window, Qt.Key.Key_Down, Qt.KeyboardModifier.AltModifier)
    assert 150 <= session.view.playhead < 160
    QTest.keyClick(window, Qt.Key.Key_Up, Qt.KeyboardModifier.AltModifier)
    assert 60 <= session.view.playhead < 80

    QTest.keyClick(window, Qt.Key.Key_W, CONTROL | SHIFT)
    qtbot.waitUntil(window.review.verdict.sentence.hasFocus)
    QTest.keyClicks(window.review.verdict.sentence, "the jaw pops")
    QTest.keyClick(window.review.verdict.sentence, Qt.Key.Key_Return)
    assert session.document.marks.verdict == "Needs work: the jaw pops"
    saved_as(qtbot, window, tmp_path / "judged.retake", monkeypatch)
    QTest.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert session.document.marks.verdict == ""
    QTest.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    np.testing.assert_array_equal(session.document.take.weights, session.document.original.weights)
    settled(qtbot, window)
    qtbot.waitUntil(lambda: not window.review.section.changes, timeout=20_000)


def test_a_verdict_is_there_when_the_project_is_opened_again(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    QTest.keyClick(window, Qt.Key.Key_Q)
    QTest.keyClicks(window.review.verdict.sentence, "lovely")
    QTest.keyClick(window, Qt.Key.Key_A, CONTROL | SHIFT)
    saved_as(qtbot, window, tmp_path / "good.retake", monkeypatch)
    load(qtbot, window, demo.BUNDLED)
    assert window.session.document.marks.verdict == ""
    load(qtbot, window, tmp_path / "good.retake")
    assert window.session.document.marks.verdict == "Approved: lovely"
    assert window.review.verdict.approve.isChecked() and window.review.verdict.sentence.text() == "lovely"
    assert window.review.verdict.history.text().startswith("Approved: lovely\n")


def test_a_take_of_another_length_is_put_on_one_clock(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    take = read_take(demo.BUNDLED)
    weights = take.weights[30:230].copy()
    weights[100:110, JAW] += 0.3
    write_take(type(take)(weights, take.fps, name="part.csv"), tmp_path / "part.csv")
    compared(qtbot, window, tmp_path / "part.csv", monkeypatch)
    assert len(window.session.document.take) == 200
    assert [(change.start, change.stop) for change in window.review.section.changes] == [(100, 110)]


def test_a_report_is_written_beside_the_work(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    compared(qtbot, window, edited(tmp_path / "b.csv", (60, 80)), monkeypatch)
    out, suggested = tmp_path / "report.html", []

    def chosen(*arguments: object) -> tuple[str, str]:
        suggested.append(Path(str(arguments[2])))
        return str(out), ""

    monkeypatch.setattr(QFileDialog, "getSaveFileName", chosen)
    with qtbot.waitSignal(window.review.reporting.written, timeout=120_000):
        window.actions_by_name["write_report"].trigger()
    text = out.read_text(encoding="utf-8")
    assert suggested[0].parent in (
        Path.home(),
        window.session.document.path.parent,
    )  # and not where the program was started
    assert "frames 60 to 79" in text and "as in b.csv" in text and "data:image/png" in text


def test_what_cannot_be_compared_is_reported_and_nothing_is_lost(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "broken.csv").write_text("x")
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(tmp_path / "broken.csv"), ""))
    with qtbot.waitSignal(window.review.failed, timeout=20_000):
        window.actions_by_name["compare_take"].trigger()
    assert window.session.document.undo.count() == 0


def test_a_project_is_compared_with_its_recording(tmp_path: Path) -> None:
    take = read_take(demo.BUNDLED)
    contents = project.Contents(take, (), 0, project.Marks())
    project.create(tmp_path / "p.retake", contents).close()
    from engine.review.pairs import review

    assert not review(None, tmp_path / "p.retake").comparison.changes


def test_a_movie_is_written_in_the_background_with_progress(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    take = read_take(demo.BUNDLED)
    write_take(Take(take.weights[60:72], take.fps), tmp_path / "short.csv")
    load(qtbot, window, tmp_path / "short.csv")
    out, shares = tmp_path / "review.mp4", []
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(out), ""))
    window.review.reporting.progress.connect(shares.append)
    with qtbot.waitSignal(window.review.reporting.written, timeout=240_000):
        window.actions_by_name["write_movie"].trigger()
    qtbot.waitUntil(lambda: window.review.reporting.idle, timeout=20_000)
    assert out.read_bytes()[4:8] == b"ftyp" and shares == sorted(shares) and shares[-1] == 1.0


def test_writing_that_is_stopped_leaves_no_file(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "review.mp4"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(out), ""))
    with qtbot.waitSignal(window.review.failed, timeout=240_000) as told:
        window.actions_by_name["write_movie"].trigger()
        window.review.handing_on.progress.button.click()
    assert told.args[0] == "Writing review.mp4 was cancelled."
    assert not [path for path in tmp_path.iterdir() if path.name.startswith("review")]


def test_flags_and_notes_are_handed_on_as_markers(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    compared(qtbot, window, edited(tmp_path / "b.csv", (60, 80)), monkeypatch)
    out = tmp_path / "notes.edl"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(out), ""))
    with qtbot.waitSignal(window.review.reporting.written, timeout=240_000):
        window.actions_by_name["write_findings"].trigger()
    assert "FCM: NON-DROP FRAME" in out.read_text() and "* LOC: " in out.read_text()
