"""Somebody who has never seen a blendshape: raises the brows, turns a smile up and out, winks, and takes each back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from engine.controls import ALL_INDEX
from tests.journeys.conftest import settled

LEFT, PLAIN = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
REST = 40  # a frame of the demo take at which the face says nothing


def show_curve(window: MainWindow, name: str) -> None:
    """Tick a curve in the menu of "+ curve"."""
    entry = next(each for each in window.brush._menu.actions() if each.data() == ALL_INDEX[name])
    entry.trigger()


def pull(qtbot: QtBot, window: MainWindow, name: str, frame: int, by_px: int) -> None:
    """Pull a curve by so many pixels, upwards for more, with the mouse."""
    session, area, index = window.session, window.curves.viewport(), ALL_INDEX[name]
    session.view.choose_lane(index)
    session.view.move_playhead(frame)
    settled(qtbot, window)
    lane = window.curves.lane(index)
    start = window.curves.mapFromScene(lane.x_of(frame), lane.y_of(float(session.document.curve(index)[frame])))
    steps = session.document.undo.index()
    QTest.mouseMove(area, start)
    QTest.mousePress(area, LEFT, PLAIN, start)
    for share in (0.5, 1.0):
        QTest.mouseMove(area, start - QPoint(0, round(share * by_px)))
        qtbot.waitUntil(lambda: session.document.draft is not None, timeout=10_000)
    QTest.mouseRelease(area, LEFT, PLAIN, start - QPoint(0, by_px))
    qtbot.waitUntil(lambda: session.document.undo.index() != steps, timeout=10_000)
    settled(qtbot, window)


@pytest.mark.parametrize(
    ("names", "by_px"),
    [
        (("brow_inner",), 30),
        (("brow_left", "brow_right"), 25),
        (("corner_height_left", "corner_left", "corner_height_right", "corner_right"), 20),
        (("eyelid_left",), -70),
    ],
    ids=("brows up", "outer brows up", "a smile up and out", "a wink"),
)
def test_a_novice_asks_for_it_gets_it_and_takes_it_back(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, names: tuple[str, ...], by_px: int
) -> None:
    session = window.session
    for name in names:
        if ALL_INDEX[name] >= 8:
            show_curve(window, name)
    before = session.document.take.weights.copy()
    curves = {name: session.document.curve(ALL_INDEX[name])[REST] for name in names}
    for name in names:
        pull(qtbot, window, name, REST, by_px)
    window.grab().save(str(tmp_path / "asked.png"))
    for name in names:
        moved = session.document.curve(ALL_INDEX[name])[REST] - curves[name]
        assert np.sign(moved) == np.sign(by_px) and abs(moved) > 0.5, (name, moved)
    assert " mm, as asked" in window.facts.outcome.text()
    for name in reversed(names):
        pull(qtbot, window, name, REST, -by_px)
    for name in names:
        assert session.document.curve(ALL_INDEX[name])[REST] == pytest.approx(curves[name], abs=1.5), (
            name
        )  # curves go along with each other
    while session.document.undo.canUndo():
        session.document.undo.undo()
    np.testing.assert_array_equal(session.document.take.weights, before)
