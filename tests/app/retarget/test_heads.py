"""How a head was read is listed in the window and corrected there, by the mouse and with undo; markers likewise."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QComboBox
from pytestqt.qtbot import QtBot

from app.retarget.actions import RetargetActions
from engine.formats.markers import write
from engine.take import SHAPE_INDEX, SHAPES
from tests.app.retarget.test_placing import choose
from tests.app.retarget.test_retargeting import LEFT, click, settle
from tests.heads import capture, write_glb

NAMES = {
    "mouthOpen": "mouthClose", "jawOpen": "jawOpen", "mouthSmleLeft": "mouthSmileLeft", "hairWind": "browInnerUp",
    "eyeBlinkLeft": "eyeBlinkLeft", "eyeBlinkRight": "eyeBlinkRight", "mouthPucker": "mouthPucker",
}  # fmt: skip


def pick(box: QComboBox, text: str) -> None:
    """Open a box by the mouse and go down to an entry by the arrow keys."""
    QTest.mouseClick(box, LEFT)
    steps = box.findText(text) - box.currentIndex()
    for _ in range(abs(steps)):
        QTest.keyClick(box.view(), Qt.Key.Key_Down if steps > 0 else Qt.Key.Key_Up)
    QTest.keyClick(box.view(), Qt.Key.Key_Return)


def opened(qtbot: QtBot, retarget: RetargetActions, path: Path, choose_file: list[Path]) -> None:
    choose_file.append(path)
    click(retarget.panel.target_button)
    qtbot.waitUntil(lambda: retarget.retargeting.target.path == path, timeout=30_000)


def moves(retarget: RetargetActions, shape: str) -> bool:
    head = retarget.retargeting.target.head
    return head is not None and bool(head.deltas[SHAPE_INDEX[shape]].any())


def test_what_was_matched_by_likeness_or_left_out_is_listed_and_corrected(
    qtbot: QtBot, retarget: RetargetActions, tmp_path: Path, choose_file: list[Path]
) -> None:
    opened(qtbot, retarget, write_glb(tmp_path / "head.glb", NAMES), choose_file)
    section, state = retarget.heads, retarget.retargeting
    assert set(section.boxes) == {"mouthOpen", "mouthSmleLeft", "hairWind"}
    assert section.boxes["mouthOpen"].currentText() == "left out" and "jawOpen" in section.boxes["mouthOpen"].toolTip()
    assert section.boxes["mouthSmleLeft"].currentText() == "mouthSmileLeft"
    assert moves(retarget, "mouthSmileLeft") and not moves(retarget, "mouthClose")

    steps = retarget._session.document.undo.count()
    pick(section.boxes["mouthOpen"], "mouthClose")
    qtbot.waitUntil(lambda: moves(retarget, "mouthClose"), timeout=30_000)
    assert retarget._session.document.undo.count() == steps + 1 and retarget._session.document.undo.isClean()
    retarget._session.document.undo.undo()
    assert not moves(retarget, "mouthClose")
    assert section.boxes["mouthOpen"].currentText() == "left out"

    QTest.mouseClick(section.all_shapes, LEFT, pos=QPoint(10, section.all_shapes.height() // 2))
    assert set(section.boxes) == set(NAMES)
    pick(section.boxes["jawOpen"], "left out")
    qtbot.waitUntil(lambda: not moves(retarget, "jawOpen"), timeout=30_000)
    settle(qtbot, retarget)
    assert state.target.reading.stored() == {"names": {"jawOpen": ""}}


def test_a_head_too_small_to_see_is_reported_and_can_be_read_in_another_unit(
    qtbot: QtBot, retarget: RetargetActions, tmp_path: Path, choose_file: list[Path]
) -> None:
    path = write_glb(tmp_path / "giant.glb", NAMES, per_mm=0.1)
    choose_file.append(path)
    with qtbot.waitSignal(retarget.failed, timeout=30_000) as told:
        click(retarget.panel.target_button)
    assert "would hardly be seen" in told.args[0] and "cm would fit" in told.args[1]
    section = retarget.heads
    assert retarget.retargeting.target.head is None and section.unit.isVisible()
    QTest.keyClick(section.unit, Qt.Key.Key_C)
    qtbot.waitUntil(lambda: retarget.retargeting.target.path == path, timeout=30_000)
    head = retarget.retargeting.target.head
    assert head is not None and 200 < np.ptp(head.neutral[:, 1]) < 400
    assert section.unit.currentText() == "cm" and retarget.retargeting.choosing.refused is None


def test_the_wheel_scrolls_past_the_boxes(
    qtbot: QtBot, retarget: RetargetActions, tmp_path: Path, choose_file: list[Path]
) -> None:
    opened(qtbot, retarget, write_glb(tmp_path / "head.glb", NAMES), choose_file)
    settle(qtbot, retarget)
    before = retarget.heads.unit.currentText()
    from PySide6.QtCore import QPointF
    from PySide6.QtGui import QWheelEvent
    from PySide6.QtWidgets import QApplication

    for box in (retarget.heads.unit, *retarget.heads.boxes.values()):
        middle = QPointF(box.rect().center())
        event = QWheelEvent(
            middle, QPointF(box.mapToGlobal(box.rect().center())), QPoint(), QPoint(0, -120),
            Qt.MouseButton.NoButton, Qt.KeyboardModifier.NoModifier, Qt.ScrollPhase.NoScrollPhase, False,
        )  # fmt: skip
        QApplication.sendEvent(box, event)
    assert retarget.heads.unit.currentText() == before and retarget.retargeting.idle


def test_markers_of_another_studio_play_without_a_file_made_by_hand_and_are_corrected(
    qtbot: QtBot, retarget: RetargetActions, tmp_path: Path, choose_file: list[Path]
) -> None:
    weights = np.zeros((30, len(SHAPES)))
    weights[:, SHAPE_INDEX["jawOpen"]] = 0.6 * np.sin(np.linspace(0, np.pi, 30))
    path = tmp_path / "studio.trc"
    write(capture(weights), path)
    choose_file.append(path)
    click(retarget.panel.markers_button)
    state = retarget.retargeting
    qtbot.waitUntil(lambda: state.capture is not None and state.target.head is not None, timeout=60_000)
    settle(qtbot, retarget)
    assert state.capture is not None
    assert set(state.capture.names) <= set(state.target.places)
    assert state.target.markers.landmarks["Mouth_Up"] == "lip_upper"
    click(retarget.panel.solve_button)
    qtbot.waitUntil(lambda: state.result is not None, timeout=60_000)
    assert state.result is not None
    assert abs(state.result.take.weights[15, SHAPE_INDEX["jawOpen"]] - weights[15, SHAPE_INDEX["jawOpen"]]) < 0.2

    box = retarget.places.show_dots
    QTest.mouseClick(box, LEFT, pos=QPoint(10, box.height() // 2))
    choose(retarget, "Mouth_Up")
    assert retarget.places.landmark.isVisible() and retarget.places.landmark.currentText() == "lip_upper"
    before = state.target.places["Mouth_Up"]
    pick(retarget.places.landmark, "philtrum")
    qtbot.waitUntil(lambda: state.target.places["Mouth_Up"] != before, timeout=30_000)
    assert state.target.markers.landmarks["Mouth_Up"] == "philtrum"
    pick(retarget.places.landmark, "left out")
    qtbot.waitUntil(lambda: "Mouth_Up" not in state.target.places, timeout=30_000)
    assert "lip_upper" in state.target.places  # for a take that is opened after it
    for _ in range(2):
        retarget._session.document.undo.undo()
    assert state.target.places["Mouth_Up"] == before and state.target.markers.landmarks["Mouth_Up"] == "lip_upper"


def test_a_kept_retarget_comes_back_on_the_head_as_it_was_corrected(
    qtbot: QtBot, retarget: RetargetActions, tmp_path: Path, choose_file: list[Path]
) -> None:
    opened(qtbot, retarget, write_glb(tmp_path / "head.glb", NAMES), choose_file)
    pick(retarget.heads.boxes["mouthOpen"], "mouthClose")
    qtbot.waitUntil(lambda: moves(retarget, "mouthClose"), timeout=30_000)
    state, session = retarget.retargeting, retarget._session
    from engine.editing import Retargeted

    state.show(Retargeted(session.document.take))
    click(retarget.panel.keep_button)
    qtbot.waitUntil(lambda: session.document.character is not None, timeout=20_000)
    assert session.document.contents().edits[-1].inputs["reading"] == {"names": {"mouthOpen": "mouthClose"}}
    state._kept_heads.forget()  # as in a program that was just started
    session.document.undo.undo()
    session.document.undo.redo()
    qtbot.waitUntil(lambda: session.document.character is not None, timeout=30_000)
    assert session.document.character.deltas[SHAPE_INDEX["mouthClose"]].any()
