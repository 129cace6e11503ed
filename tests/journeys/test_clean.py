"""The animator takes the jitter off a span: looks, changes the strength, keeps it or not."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.main_window import MainWindow
from engine.take import Take

LEFT = Qt.MouseButton.LeftButton


def test_cleaning_a_selection_is_previewed_and_kept(qtbot: QtBot, window: MainWindow) -> None:
    session = window.session
    noise = 0.02 * np.random.default_rng(0).standard_normal(session.take.weights.shape)
    rough = Take(weights=np.clip(session.take.weights + noise * (session.take.weights > 0.02), 0, 1), fps=30.0)
    session.open(rough, None)
    session.select((60, 200))
    QTest.keyClick(window, Qt.Key.Key_C)
    QTest.mouseClick(window.clean.preview_button, LEFT)
    qtbot.waitUntil(lambda: session.draft is not None, timeout=60_000)
    first = session.draft
    window.clean.strength.setValue(40)
    qtbot.waitUntil(lambda: session.draft is not first, timeout=60_000)
    weaker = np.abs(session.draft.weights - rough.weights[60:200]).mean()
    assert weaker < np.abs(first.weights - rough.weights[60:200]).mean()
    np.testing.assert_array_equal(session.take.weights, rough.weights)
    window.clean.strength.setValue(100)
    QTest.mouseClick(window.clean.keep_button, LEFT)
    qtbot.waitUntil(lambda: session.undo.index() == 1, timeout=60_000)
    shaking = np.abs(np.diff(session.take.weights[70:190], n=2, axis=0)).mean()
    assert shaking < 0.7 * np.abs(np.diff(rough.weights[70:190], n=2, axis=0)).mean()
    outside = np.r_[0:60, 200 : len(rough)]
    np.testing.assert_array_equal(session.take.weights[outside], rough.weights[outside])
