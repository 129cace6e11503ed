"""What a reviewer does with automatic findings: dismiss one with a reason, choose what is looked for, take both back."""

from __future__ import annotations

from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from engine.lab.performer import demo
from engine.review import pairs
from tests.journeys.conftest import load, saved_as, settled
from tests.journeys.test_review import compared, edited
from tests.journeys.test_review_notes import press, types

Key, CONTROL, SHIFT = Qt.Key, Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier


def test_a_finding_is_dismissed_with_a_reason_and_stays_dismissed_in_window_and_shell(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    document, view = window.session.document, window.session.view
    window.settings.author = "Ana"
    compared(qtbot, window, edited(tmp_path / "b.csv", (60, 80)), monkeypatch)
    settled(qtbot, window)
    window.curves.setFocus()
    found = document.flags
    assert found is not None
    steps = [flag for flag in found if flag.kind == "pop"]
    assert steps
    view.move_playhead(steps[0].start)
    others = [flag for flag in found if flag.start <= view.playhead < flag.stop]
    press(window, Key.Key_X)
    qtbot.waitUntil(window.flags.why.hasFocus)
    QTest.keyClick(window.flags.why, Key.Key_Return)
    assert document.marks.dismissals == ()  # who dismisses something says why
    QTest.keyClick(window.flags.why, Key.Key_Escape)
    assert not window.flags.why.isVisible()
    press(window, Key.Key_X)
    types("meant so")
    (told,) = document.marks.dismissals
    assert (told.author, told.why, told.start) == ("Ana", "meant so", steps[0].start)
    gone = next(flag for flag in others if flag.kind == told.kind)
    assert document.dismissed == (gone,) and gone not in (document.flags or ())
    assert "dismissed" in window.flags.list.item(window.flags.list.count() - 1).text()
    assert "1 finding dismissed" in window.flags.count.text()

    saved_as(qtbot, window, tmp_path / "a.retake", monkeypatch)
    kept = document.flags
    assert set(pairs.flags(tmp_path / "a.retake")) == set(kept or ())
    load(qtbot, window, demo.BUNDLED)
    load(qtbot, window, tmp_path / "a.retake")
    qtbot.waitUntil(lambda: document.flags == kept, timeout=20_000)
    assert document.dismissed == (gone,)
    view.move_playhead(gone.start)
    press(window, Key.Key_X, SHIFT)
    assert document.dismissed == () and gone in (document.flags or ())
    press(window, Key.Key_Z, CONTROL)
    assert document.dismissed == (gone,)
    settled(qtbot, window)


def test_what_is_looked_for_is_set_for_the_project_and_undone(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    document = window.session.document
    compared(qtbot, window, edited(tmp_path / "b.csv", (60, 80)), monkeypatch)
    settled(qtbot, window)
    usual = document.flags or ()
    window.actions_by_name["flag_settings"].trigger()
    dialog = window.flagged.dialog
    assert dialog is not None and dialog.isVisible()
    dialog.counts["lost"].click()
    box = dialog.thresholds["pop"]
    box.setFocus()
    box.selectAll()
    QTest.keyClicks(box, "0.5")
    QTest.keyClick(box, Key.Key_Return)
    assert document.undo.undoText() == "a step from 0.5 weight"
    expected = tuple(flag for flag in usual if flag.kind not in ("lost", "pop"))
    qtbot.waitUntil(lambda: document.flags == expected, timeout=20_000)
    dialog.close()
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow, timeout=20_000)
    saved_as(qtbot, window, tmp_path / "a.retake", monkeypatch)
    assert set(pairs.flags(tmp_path / "a.retake")) == set(expected)
    document.undo.undo()
    document.undo.undo()
    qtbot.waitUntil(lambda: document.flags == usual, timeout=20_000)
    assert dialog.counts["lost"].isChecked() and box.value() == pytest.approx(0.15)
    settled(qtbot, window)
