"""The picture of the face is of the panel's format and sharp, whatever was resized, and the original flickers no way."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QEvent, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QSplitter
from pytestqt.qtbot import QtBot

from app.preview.worker import Wanted
from app.window.main_window import MainWindow
from tests.journeys.conftest import settled


def assert_of_the_panels_format(window: MainWindow) -> None:
    face = window.preview.face
    ratio = face.devicePixelRatioF()
    assert (face.image.width(), face.image.height()) == (int(face.width() * ratio), int(face.height() * ratio))


def test_the_picture_has_the_panels_format_after_every_kind_of_resize(qtbot: QtBot, window: MainWindow) -> None:
    assert_of_the_panels_format(window)
    split = window.preview.parentWidget()
    assert isinstance(split, QSplitter)
    steps = (
        lambda: split.setSizes([300, 700]),
        lambda: split.setSizes([600, 500]),
        lambda: window.resize(1300, 700),
        window.reference.show,
        window.reference.hide,
        window.preview.hide,
        lambda: window.resize(1500, 800),
        window.preview.show,
    )
    for step in steps:
        step()
        settled(qtbot, window)
        if window.preview.isVisible():
            assert_of_the_panels_format(window)


def test_until_the_new_picture_comes_the_old_one_keeps_its_proportions(window: MainWindow) -> None:
    face = window.preview.face
    image = face.image
    for width, height in ((300, 700), (900, 500), (460, 620)):
        face.resize(width, height)
        face.image = image
        box = face.picture_box()
        assert box.width() / box.height() == pytest.approx(image.width() / image.height(), rel=0.02)
        assert box.center().x() == pytest.approx(width / 2)


def test_holding_b_draws_no_coarse_picture_and_nothing_twice(qtbot: QtBot, window: MainWindow) -> None:
    preview, session = window.preview, window.session
    session.view.move_playhead(30)
    weights = session.document.take.weights[:1].copy()
    weights[:] = 0.4
    session.document.replace_rows(
        session.view.playhead,
        weights,
        session.document.controls[:1],
        session.document.asked[:1],
        session.document.take.lost[:1],
    )
    settled(qtbot, window)
    preview._spent_ms = preview._quick_ms = 1e3  # as on a slow machine, where what moves is drawn in blocks
    shown: list[tuple[int, str]] = []
    after = preview.face.image.copy()
    drawn: list[Wanted] = []
    preview.drawing.done.connect(lambda wanted, _: drawn.append(wanted))
    for _ in range(3):
        QTest.keyPress(window.curves, Qt.Key.Key_B)
        qtbot.waitUntil(lambda: preview.face.pictured == "Before", timeout=10_000)
        shown.append((preview.face.image.width(), preview.face.pictured))
        assert preview.face.image != after
        QTest.keyRelease(window.curves, Qt.Key.Key_B)
        assert preview.face.pictured == "After" and preview.face.image == after  # at once
    settled(qtbot, window)
    assert len(drawn) == 1 and drawn[0].shot.smooth_edges
    assert preview.face.image == after and {width for width, _ in shown} == {after.width()}


def test_a_picture_that_comes_late_does_not_replace_what_is_wanted_by_now(qtbot: QtBot, window: MainWindow) -> None:
    preview = window.preview
    for _ in range(5):
        QTest.keyPress(window.curves, Qt.Key.Key_B)
        QTest.keyRelease(window.curves, Qt.Key.Key_B)
    settled(qtbot, window)
    assert preview.face.pictured == "After" == preview.face.view


def test_labels_belong_to_the_picture_that_is_shown(qtbot: QtBot, window: MainWindow) -> None:
    preview = window.preview
    preview.show_view("Split")
    assert preview.face.pictured == "After"
    settled(qtbot, window)
    assert preview.face.pictured == "Split"


def test_another_resolution_of_the_screen_brings_another_picture(qtbot: QtBot, window: MainWindow) -> None:
    with qtbot.waitSignal(window.preview.face.resized, timeout=5_000):
        QApplication.sendEvent(window.preview.face, QEvent(QEvent.Type.DevicePixelRatioChange))


def test_a_close_view_is_chosen_and_drawn(qtbot: QtBot, window: MainWindow) -> None:
    for name in ("Eyes", "Mouth"):
        before = window.preview.face.image.copy()
        window.preview.look_from(name)
        settled(qtbot, window)
        assert window.preview.face.image != before and np.abs(window.preview.face.camera.pan).max() < 0.4
