"""Close here: lids close and open as in a blink, whatever the rate, and what is said of it is what is on the screen."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.curves.brush import reach
from app.window.main_window import MainWindow
from engine.controls import CONTROL_INDEX, CONTROLS
from tests.journeys.conftest import settled

EYE, LIPS = (next(i for i, c in enumerate(CONTROLS) if c.area == "eyelids"), CONTROL_INDEX["lips_vertical"])
BLINK_S = 0.08 + 0.14


def close(qtbot: QtBot, window: MainWindow, lane: int, frame: int) -> None:
    window.session.view.choose_lane(lane)
    window.session.view.move_playhead(frame)
    steps = window.session.document.undo.index()
    QTest.mouseClick(window.value.close_button, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: window.session.document.undo.index() == steps + 1, timeout=10_000)
    settled(qtbot, window)


def test_an_eye_closes_for_a_blink_and_says_so(qtbot: QtBot, window: MainWindow) -> None:
    session, fps = window.session, window.session.document.take.fps
    close(qtbot, window, EYE, 100)
    asked = np.flatnonzero(session.document.asked[:, EYE] != session.document.original_controls[:, EYE])
    asked = asked[~np.isnan(session.document.asked[asked, EYE])]
    assert 1 < len(asked) <= BLINK_S * fps + 2
    assert session.document.controls[100, EYE] < 1.0
    told = window.facts.outcome.text()
    assert told.startswith(CONTROLS[EYE].title) and f"{session.document.controls[100, EYE]:.1f} mm, as asked" in told
    assert "believable" not in told and "limit" not in told
    shut = np.flatnonzero(np.abs(session.document.controls - session.document.original_controls)[:, EYE] > 1.0)
    assert shut[0] <= 100 <= shut[-1] and len(shut) <= BLINK_S * fps + 4  # not a wink of two seconds


def test_what_is_said_follows_the_playhead(qtbot: QtBot, window: MainWindow) -> None:
    close(qtbot, window, EYE, 100)
    session = window.session
    session.view.move_playhead(102)
    asked = session.document.asked[102, EYE]
    assert abs(session.document.controls[102, EYE] - asked) < 0.1
    assert (
        window.facts.outcome.text() == f"{CONTROLS[EYE].title} {session.document.controls[102, EYE]:.1f} mm, as asked"
    )
    session.view.move_playhead(250)
    told = window.facts.outcome.text()
    assert "mm, as asked (frame " in told and told.startswith(CONTROLS[EYE].title)


def test_lips_close_over_the_brush(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    session.view.set_brush(radius_s=0.2)
    close(qtbot, window, LIPS, 88)
    start, stop = reach(88, session.view.radius_frames, len(session.document.take))
    asked = np.flatnonzero(np.nan_to_num(session.document.asked[:, LIPS], nan=-1.0) >= 0.0)
    assert start <= asked.min() and asked.max() < stop
    assert session.document.controls[88, LIPS] < 1.0


def test_the_radius_is_in_seconds_at_every_rate(window: MainWindow) -> None:
    session = window.session
    assert window.brush.radius.suffix() == " s" and window.brush.radius.value() == pytest.approx(session.view.radius_s)
    window.brush.radius.setValue(0.75)
    assert session.view.radius_s == pytest.approx(0.75)
    assert session.view.radius_frames == pytest.approx(0.75 * session.document.take.fps)
    before = session.view.radius_s
    window.actions_by_name["wider_brush"].trigger()
    window.actions_by_name["narrower_brush"].trigger()
    assert session.view.radius_s == pytest.approx(before)
