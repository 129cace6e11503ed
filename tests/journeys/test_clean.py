"""The animator takes the jitter off a span: looks, changes the strength, keeps it or not."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from engine.take import Take

LEFT = Qt.MouseButton.LeftButton


def noisy(window: MainWindow) -> Take:
    """Open the demo take with noise on it."""
    weights = window.session.document.take.weights
    noise = 0.02 * np.random.default_rng(0).standard_normal(weights.shape)
    rough = Take(weights=np.clip(weights + noise * (weights > 0.02), 0, 1), fps=30.0)
    window.session.open(rough, None)
    return rough


def test_what_is_removed_is_drawn_under_each_curve(qtbot: QtBot, window: MainWindow) -> None:
    rough, session = noisy(window), window.session
    session.view.select((60, 200))
    session.view.set_range(0, 250)
    QTest.keyClick(window, Qt.Key.Key_C)
    assert not any(lane.removed.area.isVisible() for lane in window.curves.lanes)
    QTest.mouseClick(window.clean.preview_button, LEFT)
    qtbot.waitUntil(lambda: session.document.draft is not None, timeout=60_000)
    session.view.expand(0)
    assert len(window.curves.lanes) > 8
    for lane in window.curves.lanes:
        drawn = lane.removed.area
        frames, heights = drawn.getData()
        removed = session.document.curve(lane.key)[60:200] - session.document.draft_curve(lane.key)
        np.testing.assert_array_equal(frames, np.arange(60, 200))
        low, high = lane.range
        full = float(lane.gutter.removed.split("±")[1].split()[0])
        wanted = np.clip(removed / full, -1, 1)
        at = (heights - drawn.opts["fillLevel"]) / (0.34 / 2 * 0.8 * (high - low))
        np.testing.assert_allclose(at, wanted, atol=1e-6)
        assert (np.abs(removed) <= full).mean() >= 0.98
        assert heights.max() < session.document.curve(lane.key).min()  # it meets no curve
    before = session.document.draft
    window.clean.strength.setValue(0)
    qtbot.waitUntil(lambda: session.document.draft is not before, timeout=60_000)
    heights = window.curves.lanes[0].removed.area.getData()[1]
    assert np.ptp(heights) == 0  # the slider is live: nothing is removed at 0 %
    np.testing.assert_array_equal(session.document.take.weights, rough.weights)


def test_the_removed_curve_is_shown_or_not_by_box_and_key(qtbot: QtBot, window: MainWindow) -> None:
    noisy(window)
    lane = window.curves.lanes[0]
    fitted = lane.range
    QTest.keyClick(window, Qt.Key.Key_C)
    QTest.mouseClick(window.clean.preview_button, LEFT)
    qtbot.waitUntil(lane.removed.area.isVisible, timeout=60_000)
    assert lane.range[0] < fitted[0] and lane.range[1] == fitted[1]
    QTest.keyClick(window, Qt.Key.Key_R, Qt.KeyboardModifier.ShiftModifier)
    assert not lane.removed.area.isVisible() and lane.range == fitted and not window.clean.removed.isChecked()
    window.clean.removed.click()
    assert lane.removed.area.isVisible() and window.actions_by_name["show_removed"].isChecked()
    QTest.keyClick(window, Qt.Key.Key_V)
    assert not lane.removed.area.isVisible() and lane.range == fitted


def test_cleaning_a_selection_is_previewed_and_kept(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    rough = noisy(window)
    session.view.select((60, 200))
    QTest.keyClick(window, Qt.Key.Key_C)
    QTest.mouseClick(window.clean.preview_button, LEFT)
    qtbot.waitUntil(lambda: session.document.draft is not None, timeout=60_000)
    first = session.document.draft
    window.clean.strength.setValue(40)
    qtbot.waitUntil(lambda: session.document.draft is not first, timeout=60_000)
    weaker = np.abs(session.document.draft.weights - rough.weights[60:200]).mean()
    assert weaker < np.abs(first.weights - rough.weights[60:200]).mean()
    np.testing.assert_array_equal(session.document.take.weights, rough.weights)
    window.clean.strength.setValue(100)
    QTest.mouseClick(window.clean.keep_button, LEFT)
    qtbot.waitUntil(lambda: session.document.undo.index() == 1, timeout=60_000)
    shaking = np.abs(np.diff(session.document.take.weights[70:190], n=2, axis=0)).mean()
    assert shaking < 0.7 * np.abs(np.diff(rough.weights[70:190], n=2, axis=0)).mean()
    outside = np.r_[0:60, 200 : len(rough)]
    np.testing.assert_array_equal(session.document.take.weights[outside], rough.weights[outside])
