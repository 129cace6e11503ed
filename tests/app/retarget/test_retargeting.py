from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QPushButton
from pytestqt.qtbot import QtBot

from app.retarget.actions import RetargetActions
from app.retarget.sides import sides
from app.retarget.strengths import STEPS, position, strength_at
from app.session.commands import restored
from engine.character import Character, bundled
from engine.editing import Retargeted
from engine.extended import bundled_face
from engine.formats.markers import write
from engine.formats.markers.capture import Markers
from engine.project import replay
from engine.spacetime.layout import standard
from engine.spacetime.matching import Matching
from engine.spacetime.retarget import retarget as carry
from engine.spacetime.source import from_take
from engine.take import SHAPE_INDEX, Take

LEFT = Qt.MouseButton.LeftButton


def click(button: QPushButton) -> None:
    QApplication.processEvents()  # what was just laid out is on screen after
    assert button.isVisible() and button.isEnabled()
    QTest.mouseClick(button, LEFT)


def settle(qtbot: QtBot, retarget: RetargetActions) -> None:
    qtbot.waitUntil(lambda: retarget.retargeting.idle, timeout=60_000)
    qtbot.wait(10)  # results on their way to this thread
    qtbot.waitUntil(lambda: retarget.retargeting.idle and not retarget.retargeting.choosing.opening, timeout=60_000)


@pytest.fixture
def aimed(qtbot: QtBot, retarget: RetargetActions, other_head: Path, choose_file: list[Path]) -> RetargetActions:
    """The panel with another head for a target."""
    choose_file.append(other_head)
    click(retarget.panel.target_button)
    settle(qtbot, retarget)
    assert retarget.retargeting.ready
    return retarget


def test_a_slider_s_middle_is_the_usual_strength_and_its_left_end_none() -> None:
    assert strength_at(0, 0.1) == 0.1 and strength_at(-STEPS, 0.1) == 0
    assert all(position(strength_at(step, 30.0), 30.0) == step for step in range(-STEPS, STEPS + 1))


def test_without_a_target_the_source_stands_alone_and_solving_says_what_to_do(
    qtbot: QtBot, retarget: RetargetActions
) -> None:
    left, right = sides(retarget._session, retarget.retargeting, "", dots=False)
    assert left.weights is not None and right.weights is None and not retarget.panel.solve_button.isVisible()
    with qtbot.waitSignal(retarget.failed) as told:
        retarget.carry()
    assert "no other head" in told.args[0]


def test_the_target_follows_at_once_and_the_sliders_change_it(qtbot: QtBot, aimed: RetargetActions) -> None:
    aimed._session.view.move_playhead(30)
    settle(qtbot, aimed)
    before = aimed.retargeting.face_at(30)
    QTest.keyClick(aimed.panel.strengths.sliders["alpha"], Qt.Key.Key_End)
    settle(qtbot, aimed)
    after = aimed.retargeting.face_at(30)
    assert aimed.retargeting.matching.alpha == pytest.approx(10 * Matching().alpha)
    assert before is not None and after is not None and np.abs(after).sum() < np.abs(before).sum()
    assert len(sides(aimed._session, aimed.retargeting, "", dots=False)) == 2


def test_solving_keeping_and_undoing_is_what_the_engine_does_and_one_step(
    qtbot: QtBot, aimed: RetargetActions, other_character: Character, short_take: Take
) -> None:
    session, steps = aimed._session, aimed._session.document.undo.count()
    click(aimed.panel.solve_button)
    qtbot.waitUntil(lambda: aimed.retargeting.result is not None, timeout=60_000)
    expected = carry(from_take(short_take, bundled()), other_character)
    assert aimed.retargeting.result is not None
    np.testing.assert_allclose(aimed.retargeting.result.take.weights, expected.weights, atol=1e-9)
    np.testing.assert_array_equal(session.document.take.weights, short_take.weights)

    click(aimed.panel.keep_button)
    qtbot.waitUntil(lambda: session.document.undo.count() == steps + 1, timeout=20_000)
    np.testing.assert_allclose(session.document.take.weights, expected.weights, atol=1e-9)
    assert session.document.character is aimed.retargeting.target.head and not aimed.retargeting.ready
    assert sides(session, aimed.retargeting, "", dots=False) == ()

    session.document.undo.undo()
    np.testing.assert_array_equal(session.document.take.weights, short_take.weights)
    assert session.document.character is None and aimed.retargeting.ready


def test_a_project_that_is_opened_again_shows_the_head_it_was_kept_on(
    qtbot: QtBot, aimed: RetargetActions, other_head: Path
) -> None:
    session = aimed._session
    aimed.retargeting.show(Retargeted(session.document.take))
    click(aimed.panel.keep_button)
    qtbot.waitUntil(lambda: session.document.character is not None, timeout=20_000)
    contents = session.document.contents()
    assert contents.edits[-1].inputs["target"] == str(other_head)

    session.open(contents.original, None)
    assert session.document.character is None
    state = replay(contents)
    aimed.retargeting._kept_heads.forget()  # as in a program that was just started
    measured = tuple(bundled_face().measure(take.weights) for take in (contents.original, state.take))
    session.restore(contents, None, restored(session.document, contents, state), state, measured)
    qtbot.waitUntil(lambda: session.document.character is not None, timeout=20_000)
    assert session.document.character.name == "broad"
    session.document.undo.undo()
    assert session.document.character is None


def test_a_solve_that_is_cancelled_leaves_everything_as_it_was(qtbot: QtBot, aimed: RetargetActions) -> None:
    take, steps = aimed._session.document.take, aimed._session.document.undo.count()
    click(aimed.panel.solve_button)
    assert aimed.panel.bar.isVisible() and not aimed.panel.solve_button.isVisible()
    click(aimed.panel.cancel_button)
    settle(qtbot, aimed)
    assert aimed.retargeting.result is None and aimed.panel.solve_button.isVisible()
    assert aimed._session.document.take is take and aimed._session.document.undo.count() == steps


def test_choosing_a_head_is_no_unsaved_edit_but_can_be_undone(aimed: RetargetActions) -> None:
    assert not aimed._session.document.edited
    aimed._session.document.undo.undo()
    assert aimed.retargeting.target.head is None


def test_an_edit_of_the_take_discards_the_result_solved_from_it(qtbot: QtBot, aimed: RetargetActions) -> None:
    click(aimed.panel.solve_button)
    qtbot.waitUntil(lambda: aimed.retargeting.result is not None, timeout=60_000)
    session = aimed._session
    take = session.document.take
    session.document.replace_rows(
        0, take.weights[:1] * 0.5, session.document.controls[:1], session.document.asked[:1], take.lost[:1]
    )
    assert aimed.retargeting.result is None


def test_a_file_that_is_no_head_is_one_sentence(
    qtbot: QtBot, retarget: RetargetActions, choose_file: list[Path], tmp_path: Path
) -> None:
    wrong = tmp_path / "wrong.glb"
    wrong.write_bytes(b"no head")
    choose_file.append(wrong)
    with qtbot.waitSignal(retarget.failed, timeout=20_000) as told:
        click(retarget.panel.target_button)
    assert "wrong.glb" in told.args[0] and retarget.retargeting.target.head is None


def _capture(path: Path, fps: float = 30.0) -> np.ndarray:
    """A jaw that opens and closes, on the standard markers, one of which is lost for a while."""
    head, layout = bundled(), standard(bundled())
    jaw = np.sin(np.linspace(0, np.pi, 40))
    moved = jaw[:, None, None] * layout.deltas(head)[SHAPE_INDEX["jawOpen"]]
    places = layout.rest(head) + moved
    places[10:14, 3] = np.nan
    write(Markers(places, layout.names, fps), path)
    return jaw


def test_a_capture_stands_as_points_beside_the_head_it_moves(
    qtbot: QtBot, retarget: RetargetActions, choose_file: list[Path], tmp_path: Path
) -> None:
    jaw = _capture(tmp_path / "capture.csv")
    choose_file.append(tmp_path / "capture.csv")
    click(retarget.panel.markers_button)
    settle(qtbot, retarget)
    settle(qtbot, retarget)
    session = retarget._session
    assert len(session.document.take) == 40 and not session.document.take.weights.any() and retarget.retargeting.ready
    session.view.move_playhead(12)
    left, right = sides(session, retarget.retargeting, "", dots=False)
    assert left.weights is None and len(left.dots) == 54 and right.weights is not None
    assert np.isnan(left.dots[3].place).all() and np.isfinite(left.dots[4].place).all()

    click(retarget.panel.solve_button)
    qtbot.waitUntil(lambda: retarget.retargeting.result is not None, timeout=60_000)
    steps = session.document.undo.count()
    click(retarget.panel.keep_button)
    qtbot.waitUntil(lambda: session.document.undo.count() == steps + 1, timeout=20_000)
    np.testing.assert_allclose(session.document.take.curve("jawOpen"), jaw, atol=0.15)
    assert session.document.character is None and retarget.retargeting.capture is not None


def test_another_frame_at_rest_is_measured_from(
    qtbot: QtBot, retarget: RetargetActions, choose_file: list[Path], tmp_path: Path
) -> None:
    _capture(tmp_path / "capture.csv")
    choose_file.append(tmp_path / "capture.csv")
    click(retarget.panel.markers_button)
    settle(qtbot, retarget)
    settle(qtbot, retarget)
    retarget.panel.rest_frame.setFocus()
    QTest.keyClick(retarget.panel.rest_frame, Qt.Key.Key_Up)
    settle(qtbot, retarget)
    settle(qtbot, retarget)
    assert retarget.retargeting.capture is not None
    np.testing.assert_allclose(retarget.retargeting.capture.displacements[1], 0, atol=0.5)
    assert retarget.panel.rest_frame.value() == 1


def test_a_capture_that_is_dropped_on_the_window_is_retargeted(
    qtbot: QtBot, retarget: RetargetActions, tmp_path: Path
) -> None:
    _capture(tmp_path / "capture.trc")
    retarget.take_in(tmp_path / "capture.trc")
    settle(qtbot, retarget)
    assert retarget.retargeting.capture is not None and retarget._session.document.name == "capture.trc"
