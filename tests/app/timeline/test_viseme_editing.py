from __future__ import annotations

import re

import numpy as np
import pytest
from PySide6.QtCore import QRectF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from app.session import Session
from app.timeline.viseme_editing import VisemeEditing, _as_typed, _seconds
from app.timeline.visemes import EDGE_PX
from engine.errors import EditError
from engine.speech.lane import VisemeLane, attached, shifted
from engine.speech.visemes import Cue
from engine.take import SHAPES, Take

CUES = (Cue(1.0, 2.0, "M"), Cue(2.0, 3.0, "AA1"), Cue(4.0, 5.0, "F"))
LEFT, PER_S = 100.0, 50.0


@pytest.fixture
def editing(qtbot: QtBot) -> VisemeEditing:
    session = Session(Take(np.zeros((300, len(SHAPES))), 30.0))
    session.document.visemes = attached(CUES, "a.TextGrid")
    host = QWidget()
    qtbot.addWidget(host)
    host.resize(700, 40)
    host.show()
    return VisemeEditing(session, host, lambda: (QRectF(LEFT, 0, 10 * PER_S, 26), (0.0, 10.0)))


def x_of(time_s: float) -> float:
    return LEFT + PER_S * time_s


def times(editing: VisemeEditing) -> list[tuple[float, float]]:
    lane = editing._session.document.visemes
    assert lane is not None
    return [(round(float(start), 6), round(float(stop), 6)) for start, stop in lane.times_s]


def typed(text: str, index: int = 1) -> VisemeLane:
    return _as_typed(attached(CUES, "a"), index, text)


def test_a_name_alone_keeps_its_times_and_one_with_times_moves() -> None:
    found = typed("P")
    assert [cue.label for cue in found.cues] == ["M", "P", "F"]
    np.testing.assert_allclose(found.times_s, [[1, 2], [2, 3], [4, 5]])
    for text, begin, end in (("B 2.2 2.9", 2.2, 2.9), ("B 2.5 3.5", 2.5, 3.5), ("B 3.1 3.4s", 3.1, 3.4)):
        found = typed(text)
        assert found.cues[1].label == "B"
        np.testing.assert_allclose(found.times_s[1], [begin, end])
        np.testing.assert_allclose(found.times_s[2], [4, 5])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "'' is not a viseme"),
        ("AA 1.0", "'AA 1.0' is not a viseme"),
        ("AA 1.0 2.0 3.0", "is not a viseme"),
        ("AA one 2.0", "'one' is not a number of seconds"),
        ("AA 2.5 2.5", "must begin before it ends"),
        ("AA 2.5 2.4", "must begin before it ends"),
    ],
)
def test_what_cannot_be_typed_is_one_sentence(text: str, says: str) -> None:
    with pytest.raises(EditError, match=re.escape(says)):
        typed(text)


def test_seconds_may_have_their_unit() -> None:
    assert [_seconds(text) for text in ("2.5", " 2.5s ", "-1")] == [2.5, 2.5, -1.0]


def test_places_are_times_and_cues(editing: VisemeEditing) -> None:
    assert editing.time_at(x_of(2.5)) == pytest.approx(2.5)
    assert [editing.cue_at(x_of(at)) for at in (0.5, 1.5, 2.5, 3.5, 4.5)] == [None, 0, 1, None, 2]
    assert editing.tool_tip(x_of(2.5)).startswith("AA1: ") and editing.tool_tip(x_of(3.5)) == ""


@pytest.mark.parametrize(("off", "near"), [(EDGE_PX - 0.5, True), (EDGE_PX + 0.5, False)])
def test_a_boundary_is_taken_hold_of_from_near(editing: VisemeEditing, off: float, near: bool) -> None:
    assert (editing.edge_at(x_of(5.0) + off) is not None) == near == editing.take(x_of(5.0) + off) == editing.dragging


def test_a_boundary_moves_as_far_as_the_pointer_by_one_step(editing: VisemeEditing) -> None:
    editing.take(x_of(2.0) + 2)
    editing.move(x_of(2.0) + 2 + 10)
    assert times(editing)[1] == (2.0, 3.0)  # until it is let go
    editing.release()
    assert times(editing) == [(1.0, 2.2), (2.2, 3.0), (4.0, 5.0)]
    undo = editing._session.document.undo
    assert undo.count() == 1 and undo.undoText() == "move a viseme boundary" and not editing.dragging
    undo.undo()
    assert times(editing)[1] == (2.0, 3.0)


def test_a_boundary_that_is_not_moved_or_is_dropped_is_no_step(editing: VisemeEditing) -> None:
    editing.take(x_of(2.0))
    editing.release()
    editing.take(x_of(2.0))
    editing.move(x_of(2.4))
    assert editing.drop() and not editing.drop()
    editing.release()
    editing.move(x_of(2.4))
    assert editing._session.document.undo.count() == 0 and times(editing)[1] == (2.0, 3.0)


def test_a_lane_that_became_another_meanwhile_is_left_alone(editing: VisemeEditing) -> None:
    editing.take(x_of(2.0))
    editing.move(x_of(2.4))
    other = attached(CUES[:1], "b")
    editing._session.document.visemes = other
    editing.release()
    assert editing._session.document.visemes is other and editing._session.document.undo.count() == 0


def test_a_cue_s_frames_are_selected(editing: VisemeEditing) -> None:
    editing.select(x_of(3.5))
    assert editing._session.view.selection is None
    editing.select(x_of(2.5))
    assert editing._session.view.selection == (60, 90)


def test_what_is_typed_becomes_one_step(editing: VisemeEditing) -> None:
    editing.type_name(1)
    entry = editing.entry
    assert entry is not None and entry.text() == "AA1 2.000 3.000" and entry.selectedText() == "AA1"
    QTest.keyClicks(entry, "P")
    QTest.keyClick(entry, Qt.Key.Key_Return)
    lane = editing._session.document.visemes
    assert lane is not None and lane.cues[1].label == "P" and editing.entry is None
    assert editing._session.document.undo.undoText() == "say P"


def test_escape_drops_what_is_typed_and_nonsense_is_told(qtbot: QtBot, editing: VisemeEditing) -> None:
    editing.type_name(1)
    assert editing.entry is not None
    QTest.keyClick(editing.entry, Qt.Key.Key_Escape)
    assert editing.entry is None and editing._session.document.undo.count() == 0
    editing.type_shift()
    assert editing.entry is not None and editing.entry.text() == "0"
    editing.entry.setText("soon")
    with qtbot.waitSignal(editing.failed) as told:
        QTest.keyClick(editing.entry, Qt.Key.Key_Return)
    assert told.args[0] == "'soon' is not a number of seconds." and editing._session.document.undo.count() == 0


def test_the_lane_is_shifted_to_where_it_is_typed_or_the_playhead_is(editing: VisemeEditing) -> None:
    lane = editing._session.document.visemes
    assert lane is not None
    editing.type_shift()
    assert editing.entry is not None
    editing.entry.setText("0.5")
    QTest.keyClick(editing.entry, Qt.Key.Key_Return)
    assert times(editing)[0] == (1.5, 2.5)
    moved = editing._session.document.visemes
    assert moved is not None
    np.testing.assert_array_equal(moved.times_s, shifted(lane, 0.5).times_s)
    editing._session.view.move_playhead(90)
    editing._begin_at_playhead(moved, 1)
    assert times(editing)[1] == (3.0, 4.0)
