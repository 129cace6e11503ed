"""The animator carries a take to another head: sees it live, places a marker by a click, solves, keeps, undoes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog, QMenu
from pytestqt.qtbot import QtBot

from app.actions.table import OTHER_HEAD
from app.preview.picking import places
from app.window.main_window import MainWindow
from engine import assets
from engine.character import bundled, load, save
from engine.formats import read_take
from engine.lab.performer import demo
from engine.take import Take
from tests.journeys.conftest import load as load_file
from tests.journeys.conftest import saved_as, settled

LEFT, PLAIN = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
CONTROL, SHIFT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier
FRAME = 20


@pytest.fixture
def broad_head(tmp_path: Path) -> Path:
    head = bundled()
    stretch = np.array([1.25, 0.95, 1.1], np.float32)
    save(replace(head, neutral=head.neutral * stretch, deltas=0.8 * head.deltas * stretch), tmp_path / "broad.npz")
    return tmp_path / "broad.npz"


def retargeted(qtbot: QtBot, window: MainWindow) -> None:
    state = window.retarget.retargeting
    qtbot.waitUntil(lambda: state.idle and not state.choosing.opening, timeout=60_000)
    settled(qtbot, window)


def click_at(window: MainWindow, x: float, y: float) -> None:
    QTest.mouseClick(window.preview.face, LEFT, PLAIN, QPoint(round(x), round(y)))


def place_the_chin(qtbot: QtBot, window: MainWindow) -> None:
    """Choose a marker by its dot on the source, and move it by a click on the target; dragging places nothing."""
    retarget, face = window.retarget, window.preview.face
    QTest.mouseClick(retarget.places.show_dots, LEFT, PLAIN, QPoint(10, retarget.places.show_dots.height() // 2))
    retargeted(qtbot, window)
    overlay = face.overlay
    assert overlay is not None
    chin = retarget.retargeting.names.index("chin")
    click_at(window, *overlay.at[0][chin])
    assert retarget.placing.chosen == "chin"
    retargeted(qtbot, window)
    overlay, before = face.overlay, retarget.retargeting.target.places["chin"]
    assert overlay is not None
    x, y = overlay.at[1][chin]
    click_at(window, x + 6, y - 8)
    moved = retarget.retargeting.target.places["chin"]
    assert moved != before and retarget.retargeting.target.by_hand == {"chin"}
    retargeted(qtbot, window)
    assert face.overlay is not None
    assert np.hypot(*(face.overlay.at[1][chin] - (x + 6, y - 8))) < 8  # the nearest vertex, in pixels
    np.testing.assert_allclose(
        places(face.overlay.sides[1])[chin],
        face.overlay.sides[1].head.vertices(face.overlay.sides[1].weights)[moved],  # type: ignore[union-attr,arg-type]
        atol=1e-3,
    )

    QTest.mousePress(face, LEFT, PLAIN, QPoint(round(x), round(y)))
    QTest.mouseMove(face, QPoint(round(x) + 60, round(y)))
    QTest.mouseRelease(face, LEFT, PLAIN, QPoint(round(x) + 60, round(y)))
    assert face.camera.around_deg != 0 and retarget.retargeting.target.places["chin"] == moved


def test_a_take_is_retargeted_to_another_head_and_back(
    qtbot: QtBot, window: MainWindow, broad_head: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session, retarget, face = window.session, window.retarget, window.preview.face
    take = read_take(demo.BUNDLED)
    session.open(Take(take.weights[60:100], take.fps), None)  # short, so that solving it takes no minute
    session.view.move_playhead(FRAME)
    alone = window.preview.width()
    QTest.keyClick(window, Qt.Key.Key_T)
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(broad_head), ""))
    QTest.mouseClick(retarget.panel.target_button, LEFT)
    qtbot.waitUntil(lambda: retarget.retargeting.ready, timeout=30_000)
    retargeted(qtbot, window)
    assert face.overlay is not None and len(face.overlay.sides) == 2 and window.preview.width() > alone
    known = retarget.retargeting.face_at(FRAME)
    assert known is not None and known.any()

    before = retarget.retargeting.target.places["chin"]
    place_the_chin(qtbot, window)

    steps = session.document.undo.count()
    QTest.keyClick(window, Qt.Key.Key_Return, CONTROL)
    assert retarget.retargeting.share is not None
    QTest.keyClick(window, Qt.Key.Key_Escape)
    assert retarget.retargeting.share is None
    QTest.keyClick(window, Qt.Key.Key_Return, CONTROL)
    qtbot.waitUntil(lambda: retarget.retargeting.result is not None, timeout=120_000)
    np.testing.assert_array_equal(session.document.take.weights, session.document.original.weights)
    QTest.keyClick(window, Qt.Key.Key_Return, CONTROL | SHIFT)
    qtbot.waitUntil(lambda: session.document.undo.count() == steps + 1, timeout=20_000)
    assert session.document.undo.undoText() == "retarget to broad"
    assert (
        session.document.take.weights != session.document.original.weights
    ).any() and session.document.character is not None
    retargeted(qtbot, window)
    assert face.overlay is None and window.preview.width() == alone

    QTest.keyClick(window, Qt.Key.Key_Z, CONTROL)
    np.testing.assert_array_equal(session.document.take.weights, session.document.original.weights)
    assert session.document.character is None
    QTest.keyClick(window, Qt.Key.Key_Z, CONTROL)
    assert retarget.retargeting.target.places["chin"] == before


def test_the_head_a_take_is_shown_on_is_the_target_until_another_is_chosen(
    qtbot: QtBot, window: MainWindow, broad_head: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    retarget, steps = window.retarget.retargeting, window.session.document.undo.count()
    chosen = [str(broad_head), "", str(broad_head), str(broad_head), str(tmp_path / "no.glb")]
    (tmp_path / "no.glb").write_bytes(b"no head")
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (chosen.pop(0), ""))
    window.actions_by_name["load_character"].trigger()
    assert (
        window.status["notice"].text() == "reading broad.npz…" and window.session.view.head is None
    )  # beside the work
    retargeted(qtbot, window)
    assert not window.status["notice"].text()
    QTest.keyClick(window, Qt.Key.Key_T)
    retargeted(qtbot, window)
    assert retarget.ready and window.session.document.undo.count() == steps and not window.session.document.edited
    shown, overlay = window.session.view.head, window.preview.face.overlay
    assert retarget.target.head is shown and retarget.target.path == broad_head and "chin" in retarget.target.places
    assert overlay is not None and overlay.sides[1].head is shown

    window.actions_by_name["load_character"].trigger()  # cancelled: the head stays
    retargeted(qtbot, window)
    assert window.session.view.head is shown and window.preview.face.head is shown
    window.actions_by_name["own_head"].trigger()
    retargeted(qtbot, window)
    assert retarget.target.head is None and window.session.view.head is None

    QTest.mouseClick(window.retarget.panel.target_button, LEFT)
    retargeted(qtbot, window)
    mine = retarget.target.head
    window.actions_by_name["load_character"].trigger()
    retargeted(qtbot, window)
    shown = window.session.view.head
    assert shown is not None and shown is not mine and retarget.target.head is mine

    window.actions_by_name["load_character"].trigger()
    retargeted(qtbot, window)
    assert "no.glb" in window.notices.text.text() and not window.status["notice"].text()
    assert window.session.view.head is shown and retarget.target.head is mine


def test_the_second_head_is_in_the_menu_and_a_retarget_to_it_comes_back_with_the_project(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session, state = window.session, window.retarget.retargeting
    take = read_take(demo.BUNDLED)
    session.open(Take(take.weights[60:70], take.fps), None)
    (menu,) = [each for each in window.menus._menus["View"].findChildren(QMenu) if each.title() == OTHER_HEAD]
    assert [action.text() for action in menu.actions()] == ["Retake head", "Second head", "From a file…"]
    menu.actions()[1].trigger()
    qtbot.waitUntil(lambda: session.view.head is not None, timeout=30_000)
    shown = session.view.head
    assert shown is not None and shown.name == "Second head" and window.preview.face.head is shown
    assert len(shown.neutral) == len(load(assets.SECOND_HEAD).neutral) and session.document.character is None
    assert "hold B" in window.preview.hint.text()

    QTest.keyClick(window, Qt.Key.Key_T)
    qtbot.waitUntil(lambda: state.ready, timeout=30_000)
    retargeted(qtbot, window)
    assert state.target.head is shown and "hold B" not in window.preview.hint.text()  # the sides hide Before
    QTest.keyClick(window, Qt.Key.Key_Return, CONTROL)
    qtbot.waitUntil(lambda: state.result is not None, timeout=120_000)
    QTest.keyClick(window, Qt.Key.Key_Return, CONTROL | SHIFT)
    qtbot.waitUntil(lambda: session.document.character is not None, timeout=20_000)
    edit = session.document.contents().edits[-1]
    assert (edit.title, edit.inputs["target"]) == ("retarget to Second head", "second")  # and no path of this machine

    project = tmp_path / "second.retake"
    saved_as(qtbot, window, project, monkeypatch)
    load_file(qtbot, window, demo.BUNDLED)
    assert session.document.character is None and session.view.head is None
    load_file(qtbot, window, project)
    qtbot.waitUntil(lambda: session.document.character is not None, timeout=30_000)
    assert session.view.head is session.document.character and session.view.head.name == "Second head"
    retargeted(qtbot, window)
