from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.retarget.actions import RetargetActions
from app.retarget.solving import LABELS
from engine.formats.labels import read
from engine.take import SHAPE_INDEX
from tests.app.retarget.test_retargeting import aimed, click, settle

__all__ = ["aimed"]  # a fixture
JAW = SHAPE_INDEX["jawOpen"]


@pytest.fixture
def labelling(qtbot: QtBot, aimed: RetargetActions) -> RetargetActions:
    """The panel with the method of labels, and frames suggested."""
    aimed.panel.method.setFocus()
    QTest.keyClick(aimed.panel.method, Qt.Key.Key_Down)
    aimed.retargeting.use(method=LABELS)
    click(aimed.panel.labels.suggest_button)
    settle(qtbot, aimed)
    assert len(aimed.panel.labels.frames) == 4
    return aimed


def label(retarget: RetargetActions, frame: int, value: int) -> None:
    """Go to a suggested frame, type a search, press a slider to a value, label."""
    labels = retarget.panel.labels
    click(labels.frames[frame])
    assert retarget._session.view.playhead == frame
    labels.weights.search.clear()
    QTest.keyClicks(labels.weights.search, "jawopen")
    bar = labels.weights.sliders["jawOpen"]
    QTest.keyClick(bar, Qt.Key.Key_Home)
    for _ in range(value // 10):
        QTest.keyClick(bar, Qt.Key.Key_PageUp)
    click(labels.label_button)


def test_labels_are_met_and_the_least_certain_frame_is_offered_next(
    qtbot: QtBot, labelling: RetargetActions, tmp_path: Path, choose_file: list[Path]
) -> None:
    first, second = labelling.retargeting.suggestions[:2]
    label(labelling, first, 100)
    label(labelling, second, 20)
    target = labelling.retargeting.target
    assert sorted(target.labels) == sorted((first, second))
    assert target.labels[first]["jawOpen"] == 0.5 and "labelled" in labelling.panel.labels.frames[first].text()
    click(labelling.panel.solve_button)
    qtbot.waitUntil(lambda: labelling.retargeting.result is not None, timeout=60_000)
    result = labelling.retargeting.result
    assert result is not None and result.uncertainty is not None
    np.testing.assert_allclose(result.take.weights[[first, second], JAW], [0.5, 0.1], atol=0.02)

    click(labelling.panel.labels.loosest_button)
    loosest = labelling._session.view.playhead
    assert result.uncertainty[loosest] == result.uncertainty.max() and loosest not in target.labels
    click(labelling.panel.labels.label_button)
    assert loosest in labelling.retargeting.target.labels
    click(labelling.panel.solve_button)
    qtbot.waitUntil(lambda: labelling.retargeting.share is None, timeout=60_000)
    again = labelling.retargeting.result
    assert again is not None and again is not result and again.uncertainty is not None
    assert again.uncertainty[loosest] < result.uncertainty[loosest]

    choose_file.append(tmp_path / "labels.json")
    click(labelling.panel.save_button)
    assert read(tmp_path / "labels.json").labels == dict(labelling.retargeting.target.labels)
    for _ in range(3):
        labelling._session.document.undo.undo()
    assert not labelling.retargeting.target.labels
    choose_file.append(tmp_path / "labels.json")
    click(labelling.panel.read_button)
    assert sorted(labelling.retargeting.target.labels) == sorted((first, second, loosest))


def test_solving_without_a_label_says_what_to_do(qtbot: QtBot, labelling: RetargetActions) -> None:
    with qtbot.waitSignal(labelling.failed) as told:
        click(labelling.panel.solve_button)
    assert "No frame is labelled" in told.args[0]


def test_labels_of_a_longer_take_are_refused(
    qtbot: QtBot, labelling: RetargetActions, tmp_path: Path, choose_file: list[Path]
) -> None:
    (tmp_path / "labels.json").write_text('{"labels": [{"frame": 60, "weights": {}}]}')
    choose_file.append(tmp_path / "labels.json")
    with qtbot.waitSignal(labelling.failed) as told:
        click(labelling.panel.read_button)
    assert "the take has 60 frames" in told.args[0] and not labelling.retargeting.target.labels


def test_a_label_file_that_names_its_head_opens_that_head_in_one_step(
    qtbot: QtBot, retarget: RetargetActions, other_head: Path, tmp_path: Path, choose_file: list[Path]
) -> None:
    head = tmp_path / "broad.npz"
    head.write_bytes(other_head.read_bytes())
    (tmp_path / "labels.json").write_text(
        '{"target": "broad.npz", "labels": [{"frame": 12, "weights": {"jawOpen": 0.4}}]}'
    )
    state, undo = retarget.retargeting, retarget._session.document.undo
    choose_file.extend(2 * [tmp_path / "labels.json"])
    retarget.read_labels()  # from the menu: its button comes with the method
    settle(qtbot, retarget)
    target = state.target
    assert target.path == head and target.head is not None and target.head.name == "broad" and "chin" in target.places
    assert target.labels == {12: {"jawOpen": 0.4}} and state.method == LABELS and state.ready and undo.count() == 1
    assert list(retarget.panel.labels.frames) == [12]

    click(retarget.panel.labels.frames[12])
    click(retarget.panel.labels.unlabel_button)
    click(retarget.panel.read_button)  # again: the head is there already
    settle(qtbot, retarget)
    assert state.target.head is target.head and state.target.labels == target.labels
    for _ in range(3):
        undo.undo()
    assert state.target.head is None and not state.target.labels


def test_labels_for_a_head_that_is_not_there_change_nothing_and_say_so(
    qtbot: QtBot, labelling: RetargetActions, tmp_path: Path, choose_file: list[Path]
) -> None:
    (tmp_path / "labels.json").write_text('{"target": "gone.npz", "labels": [{"frame": 12, "weights": {}}]}')
    before = labelling.retargeting.target
    choose_file.append(tmp_path / "labels.json")
    with qtbot.waitSignal(labelling.failed, timeout=20_000) as told:
        click(labelling.panel.read_button)
    assert "gone.npz" in told.args[0] and labelling.retargeting.target is before
