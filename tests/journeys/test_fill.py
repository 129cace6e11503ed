"""The animator fills what the tracker lost, chooses among variants, and marks a span of their own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog
from pytestqt.qtbot import QtBot

from app.session.commands import MarkCommand
from app.spans.filling import VARIANTS
from app.timeline.panel import RULER_PX
from app.window.main_window import MainWindow
from engine.formats import read_take, write_take
from engine.lab.performer import demo
from engine.project import Pin, Span
from engine.take import SHAPES, Take
from tests.journeys.conftest import load, saved_as

LEFT, PLAIN = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier


def on_lane(window: MainWindow, frame: float) -> QPoint:
    timeline = window.timeline
    return QPoint(round(timeline.x_of(frame)), round(timeline.lane_box("spans").center().y()))


def test_a_lost_span_is_filled_with_the_chosen_variant(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    (lost,) = session.document.marks.spans
    assert lost.kind == "lost" and RULER_PX > 0
    QTest.mouseClick(window.timeline, LEFT, PLAIN, on_lane(window, (lost.start + lost.stop) / 2))
    assert session.view.selection == (lost.start, lost.stop)
    QTest.keyClick(window, Qt.Key.Key_F)
    qtbot.waitUntil(lambda: len(window.filling.variants) == VARIANTS, timeout=60_000)
    assert session.document.draft is window.filling.variants[0]
    QTest.keyClick(window, Qt.Key.Key_Right)
    QTest.keyClick(window, Qt.Key.Key_Right)
    assert session.document.draft is window.filling.variants[2]
    wanted = window.filling.variants[2].weights
    QTest.keyClick(window, Qt.Key.Key_Return)
    assert (
        session.document.undo.index() == 1
        and session.document.undo.undoText() == f"fill {lost.stop - lost.start} frames"
    )
    np.testing.assert_array_equal(session.document.take.weights[lost.start : lost.stop], wanted)
    outside = np.r_[0 : lost.start, lost.stop : len(session.document.take)]
    np.testing.assert_array_equal(session.document.take.weights[outside], session.document.original.weights[outside])

    QTest.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    np.testing.assert_array_equal(session.document.take.weights, session.document.original.weights)


def test_a_span_is_marked_in_the_lane_and_unmarked_again(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    start, stop = on_lane(window, 100), on_lane(window, 130)
    QTest.mousePress(window.timeline, LEFT, PLAIN, start)
    QTest.mouseMove(window.timeline, stop)
    QTest.mouseRelease(window.timeline, LEFT, PLAIN, stop)
    marked = [span for span in session.document.marks.spans if span.kind == "user"]
    assert len(marked) == 1 and abs(marked[0].start - 100) <= 1 and abs(marked[0].stop - 131) <= 1
    QTest.mouseClick(window.spans.remove_button, LEFT)
    assert all(span.kind == "lost" for span in session.document.marks.spans)
    QTest.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert marked[0] in session.document.marks.spans


def test_discarding_a_fill_leaves_the_take_as_it_was(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    session.document.undo.clear()
    session.view.select((120, 180))
    QTest.keyClick(window, Qt.Key.Key_F)
    qtbot.waitUntil(lambda: bool(window.filling.variants), timeout=60_000)
    QTest.keyClick(window, Qt.Key.Key_Escape)
    assert session.document.draft is None and session.document.undo.count() == 0 and not window.filling.variants
    np.testing.assert_array_equal(session.document.take.weights, session.document.original.weights)


def test_a_fill_without_a_span_says_what_to_do(qtbot: QtBot, window: MainWindow) -> None:
    window.session.document.set_marks(replace(window.session.document.marks, spans=()))
    QTest.keyClick(window, Qt.Key.Key_F)
    assert window.notices.isVisible() and "span" in window.notices.text.text()
    assert Span(1, 2) not in window.session.document.marks.spans


def refusal(qtbot: QtBot, window: MainWindow, frames: tuple[int, int]) -> str:
    """Ask for a fill of some frames that cannot be; return what the window says, having changed nothing."""
    session = window.session
    before, steps = session.document.take, session.document.undo.count()
    session.view.select(frames)
    QTest.keyClick(window, Qt.Key.Key_F)
    qtbot.waitUntil(lambda: window.notices.isVisible() and not window.filling.busy, timeout=60_000)
    assert session.document.take is before and session.document.draft is None and session.document.undo.count() == steps
    return window.notices.text.text()


def test_a_span_of_one_frame_or_of_everything_is_refused(qtbot: QtBot, window: MainWindow) -> None:
    assert "one frame" in refusal(qtbot, window, (50, 51))
    assert "whole take" in refusal(qtbot, window, (0, len(window.session.document.take)))


@pytest.mark.parametrize(
    ("frames", "fps", "says"), [(40, 30.0, "does not cover the span"), (400, 60.0, "60 frames per second")]
)
def test_a_guide_of_another_length_or_rate_is_refused(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, frames: int, fps: float, says: str
) -> None:
    write_take(Take(np.zeros((frames, 52)), fps), tmp_path / "guide.csv")
    (lost,) = window.session.document.marks.spans
    window.session.view.select((lost.start, lost.stop))
    window.spans.guide_by(tmp_path / "guide.csv")
    assert window.spans.guide_shift.isVisibleTo(window.spans)
    assert says in refusal(qtbot, window, (100, 140))


def test_overlapping_marks_are_refused(window: MainWindow) -> None:
    session = window.session
    for frames in ((100, 130), (120, 150)):
        session.view.select(frames)
        window.spans.mark()
    assert [(span.start, span.stop) for span in session.document.marks.spans if span.kind == "user"] == [(100, 130)]
    assert "Frames 100 to 129" in window.notices.text.text()


def test_pins_inside_are_met_pins_outside_are_left_alone_and_others_keep_the_steering(
    qtbot: QtBot, window: MainWindow
) -> None:
    session = window.session
    pins = (Pin(30, {"jawOpen": 0.9}, 20, 40), Pin(120, {"jawOpen": 0.7}, 110, 130))
    session.document.undo.push(MarkCommand.of(session.document, replace(session.document.marks, pins=pins), "pins"))
    session.view.select((100, 150))
    QTest.keyClick(window, Qt.Key.Key_F)
    for seed in (0, VARIANTS):
        qtbot.waitUntil(lambda: bool(window.filling.variants) and not window.filling.busy, timeout=60_000)
        assert f"seed {seed}" in window.spans.seed.text()
        for variant in window.filling.variants:
            assert variant.weights[20, list(SHAPES).index("jawOpen")] == pytest.approx(0.7, abs=1e-6)
        QTest.mouseClick(window.spans.again_button, LEFT)
    window.filling.drop()
    np.testing.assert_array_equal(session.document.take.weights, session.document.original.weights)


def filled(qtbot: QtBot, window: MainWindow, frames: tuple[int, int], *, choose: int = 0) -> None:
    """Fill frames by key, and keep the variant."""
    window.session.view.select(frames)
    QTest.keyClick(window, Qt.Key.Key_F)
    qtbot.waitUntil(lambda: bool(window.filling.variants) and not window.filling.busy, timeout=60_000)
    for _ in range(choose):
        QTest.keyClick(window, Qt.Key.Key_Right)
    QTest.keyClick(window, Qt.Key.Key_Return)


def exported(window: MainWindow, path: Path, monkeypatch: pytest.MonkeyPatch) -> Take:
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(path), ""))
    QTest.keyClick(window, Qt.Key.Key_E, Qt.KeyboardModifier.ControlModifier)
    return read_take(path)


def test_what_is_filled_is_exported_and_undoing_it_exports_the_lost_rows_again(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = window.session
    (lost,) = session.document.marks.spans
    filled(qtbot, window, (lost.start, lost.stop - 4))
    assert np.flatnonzero(session.document.take.lost).tolist() == list(range(lost.stop - 4, lost.stop))
    again = exported(window, tmp_path / "a.csv", monkeypatch)
    np.testing.assert_array_equal(again.lost, session.document.take.lost)
    np.testing.assert_allclose(again.weights, session.document.take.weights, atol=1e-9)
    np.testing.assert_allclose(again.rotations, session.document.take.rotations, atol=1e-9)
    QTest.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    np.testing.assert_array_equal(session.document.take.lost, session.document.original.lost)
    exported(window, tmp_path / "b.csv", monkeypatch)
    assert (tmp_path / "b.csv").read_bytes() == demo.BUNDLED.read_bytes()


def test_a_saved_project_knows_what_is_still_lost_and_how_its_fill_was_made(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Save, open anew, export; undo brings the lost frames back; made again, the fill is the same to the bit."""
    session = window.session
    (lost,) = session.document.marks.spans
    lane = session.document.asked.copy()
    lane[lost.start : lost.start + 9, 0] = 12.0 + 1 / 3
    session.document.asked = lane
    window.spans.curves.setChecked(True)
    filled(qtbot, window, (lost.start, lost.stop), choose=2)
    kept = session.document.take.weights.copy()
    saved_as(qtbot, window, tmp_path / "a.retake", monkeypatch)
    exported(window, tmp_path / "a.csv", monkeypatch)
    load(qtbot, window, demo.BUNDLED)
    load(qtbot, window, tmp_path / "a.retake")
    assert not session.document.take.lost.any()
    exported(window, tmp_path / "b.csv", monkeypatch)
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()

    QTest.keyClick(window, Qt.Key.Key_R, Qt.KeyboardModifier.ControlModifier)
    qtbot.waitUntil(lambda: bool(window.filling.variants) and not window.filling.busy, timeout=60_000)
    np.testing.assert_array_equal(session.document.take.lost, session.document.original.lost)
    QTest.keyClick(window, Qt.Key.Key_Return)
    np.testing.assert_array_equal(session.document.take.weights, kept)
    QTest.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    exported(window, tmp_path / "c.csv", monkeypatch)
    assert (tmp_path / "c.csv").read_bytes() == demo.BUNDLED.read_bytes()


def test_other_spans_lend_nothing_and_those_to_be_made_are_no_context(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    (lost,) = session.document.marks.spans
    spans = (Span(60, 90), Span(100, 130), lost)
    session.document.undo.push(MarkCommand.of(session.document, replace(session.document.marks, spans=spans), "mark"))
    filled(qtbot, window, (60, 90))
    first = session.document.undo.command(session.document.undo.index() - 1).edit.inputs
    assert first["besides"] == first["unmade"] == [[100, 130], [lost.start, lost.stop]]
    filled(qtbot, window, (100, 130))
    second = session.document.undo.command(session.document.undo.index() - 1).edit.inputs
    assert second["besides"] == [[60, 90], [lost.start, lost.stop]] and second["unmade"] == [[lost.start, lost.stop]]


def test_filling_again_shows_other_variants_and_a_bridge_is_one(qtbot: QtBot, window: MainWindow) -> None:
    filled(qtbot, window, (100, 130))
    kept = window.session.document.take.weights[100:130].copy()
    window.session.view.select((100, 130))
    for number in (7, 13):
        QTest.keyClick(window, Qt.Key.Key_F)
        qtbot.waitUntil(lambda: bool(window.filling.variants) and not window.filling.busy, timeout=60_000)
        assert window.spans.seed.text().startswith(f"Variant {number} ")
        assert all(np.abs(variant.weights - kept).max() > 1e-3 for variant in window.filling.variants)
    window.filling.drop()
    window.session.view.select((100, 104))
    QTest.keyClick(window, Qt.Key.Key_F)
    qtbot.waitUntil(lambda: bool(window.filling.variants) and not window.filling.busy, timeout=60_000)
    assert len(window.filling.variants) == 1 and not window.spans.again_button.isEnabled()


def test_a_guide_stays_until_it_is_taken_away_or_another_take_is_opened(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    spans = window.spans
    write_take(window.session.document.take, tmp_path / "guide.csv")
    window.session.view.select((100, 130))
    spans.mark()
    for answer, named in ((str(tmp_path / "guide.csv"), True), ("", True)):
        monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_, answer=answer: (answer, ""))
        QTest.mouseClick(spans.guide_button, LEFT)
        assert ("guide.csv" in spans.guide_button.text()) is named
    (tmp_path / "bad.csv").write_text("nothing")
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(tmp_path / "bad.csv"), ""))
    QTest.mouseClick(spans.guide_button, LEFT)
    assert "guide.csv" in spans.guide_button.text() and "bad.csv" in window.notices.text.text()
    assert spans.unguide_button.isVisibleTo(spans)
    QTest.mouseClick(spans.unguide_button, LEFT)
    assert "guide.csv" not in spans.guide_button.text() and not spans.unguide_button.isVisibleTo(spans)
    spans.guide_by(tmp_path / "guide.csv")
    window.session.document.undo.setClean()
    load(qtbot, window, tmp_path / "guide.csv")
    assert "guide.csv" not in spans.guide_button.text()
