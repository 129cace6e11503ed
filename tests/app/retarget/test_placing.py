from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QPoint
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.retarget.actions import RetargetActions
from engine.formats.markers.layout import read
from tests.app.retarget.test_retargeting import LEFT, aimed, click, settle

__all__ = ["aimed"]  # a fixture


def choose(retarget: RetargetActions, name: str) -> None:
    """Click a marker in the list."""
    listed = retarget.places.list
    item = listed.item(retarget.retargeting.names.index(name))
    listed.scrollToItem(item)
    QTest.mouseClick(listed.viewport(), LEFT, pos=listed.visualItemRect(item).center())
    assert retarget.placing.chosen == name


def shown(retarget: RetargetActions, name: str) -> str:
    return retarget.places.list.item(retarget.retargeting.names.index(name)).text()


def test_a_marker_is_moved_removed_and_brought_back(qtbot: QtBot, aimed: RetargetActions) -> None:
    box = aimed.places.show_dots
    QTest.mouseClick(box, LEFT, pos=QPoint(10, box.height() // 2))
    assert box.isChecked() and aimed.places.list.isVisible()
    before = aimed.retargeting.target.places["chin"]
    choose(aimed, "chin")
    aimed.pick(1, 77)
    assert aimed.retargeting.target.places["chin"] == 77 and "by hand" in shown(aimed, "chin")
    aimed.pick(1, 78)
    assert aimed.retargeting.target.places["chin"] == 78
    click(aimed.places.remove_button)
    assert "chin" not in aimed.retargeting.target.places and "not placed" in shown(aimed, "chin")
    for _ in range(3):
        aimed._session.document.undo.undo()
    assert aimed.retargeting.target.places["chin"] == before and "by hand" not in shown(aimed, "chin")


def test_a_removed_marker_s_click_goes_on_to_the_next_that_is_missing(aimed: RetargetActions) -> None:
    aimed.places.show_dots.setChecked(True)
    for name in ("glabella", "chin"):
        choose(aimed, name)
        click(aimed.places.remove_button)
    aimed.pick(1, 40)
    assert aimed.placing.chosen == "glabella"


def test_the_others_follow_four_and_with_fewer_it_says_so(qtbot: QtBot, aimed: RetargetActions) -> None:
    aimed.places.show_dots.setChecked(True)
    right = dict(aimed.retargeting.target.places)
    with qtbot.waitSignal(aimed.failed, timeout=20_000) as told:
        click(aimed.places.rest_button)
    assert "0 markers placed by hand" in told.args[0]
    for name in ("nose_tip", "chin", "brow_outer_left", "brow_outer_right", "mouth_left"):
        choose(aimed, name)
        aimed.pick(1, right[name])
    click(aimed.places.rest_button)
    settle(qtbot, aimed)
    placed = aimed.retargeting.target
    assert len(placed.places) == 54 and len(placed.by_hand) == 5
    assert all(placed.places[name] == right[name] for name in placed.by_hand)


def test_landmark_files_are_written_and_read(
    qtbot: QtBot, aimed: RetargetActions, tmp_path: Path, choose_file: list[Path]
) -> None:
    aimed.places.show_dots.setChecked(True)
    choose(aimed, "chin")
    aimed.pick(1, 99)
    path = tmp_path / "landmarks.csv"
    choose_file += [path, path]
    click(aimed.places.save_button)
    assert aimed.retargeting.target.head is not None
    assert read(path, head=aimed.retargeting.target.head)["chin"] == 99
    aimed._session.document.undo.undo()
    click(aimed.places.read_button)
    assert aimed.retargeting.target.places["chin"] == 99
    path.write_text("marker,vertex\nchin,99999999\n")
    choose_file.append(path)
    with qtbot.waitSignal(aimed.failed) as told:
        click(aimed.places.read_button)
    assert "row 2" in told.args[0]
