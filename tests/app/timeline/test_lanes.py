"""The lanes of visemes and flags under real mouse and key events."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QColor, QContextMenuEvent, QImage, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.session import Session
from app.theme import DARK, LIGHT
from app.timeline.flags import APART_PX
from app.timeline.panel import Timeline
from app.timeline.visemes import BAR_PX, choices, group_colours
from engine.quality import Flag
from engine.speech.lane import GROUPS, VisemeLane, attached
from engine.speech.visemes import NAMES, Cue, class_of
from engine.take import SHAPES, Take

LEFT, PLAIN = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
FPS = 30.0
CUES = (Cue(1.0, 2.0, "M"), Cue(2.0, 3.0, "AA1"), Cue(4.0, 5.0, "F"))


@pytest.fixture
def timeline(qtbot: QtBot) -> Iterator[Timeline]:
    session = Session(Take(weights=np.zeros((300, len(SHAPES))), fps=FPS))
    shown = Timeline(session, DARK, gutter_px=100)
    qtbot.addWidget(shown)
    session.document.visemes = attached(CUES, "a.TextGrid")
    shown.resize(100 + 600 + 18, 120)
    session.view.set_range(0, 300)
    with qtbot.waitExposed(shown):
        shown.show()
    yield shown


def at(timeline: Timeline, time_s: float, lane: str = "visemes") -> QPoint:
    return QPoint(round(timeline.x_of(time_s * FPS)), round(timeline.lane_box(lane).center().y()))


def drag(timeline: Timeline, start: QPoint, stop: QPoint) -> None:
    QTest.mousePress(timeline, LEFT, PLAIN, start)
    for part in (0.5, 1.0):
        QTest.mouseMove(timeline, start + (stop - start) * part)
    QTest.mouseRelease(timeline, LEFT, PLAIN, stop)


def lane_of(timeline: Timeline) -> VisemeLane:
    lane = timeline._session.document.visemes
    assert lane is not None
    return lane


def test_a_boundary_is_dragged_by_one_undo_step_and_the_originals_stay(timeline: Timeline) -> None:
    session, before = timeline._session, lane_of(timeline)
    drag(timeline, at(timeline, 2.0), at(timeline, 2.4))
    moved = lane_of(timeline)
    assert abs(moved.cues[0].stop_s - 2.4) < 0.02 and moved.cues[1].start_s == moved.cues[0].stop_s
    assert moved.originals == CUES and session.document.undo.count() == 1
    QTest.mouseClick(timeline, LEFT, PLAIN, at(timeline, 2.41))  # taken hold of and not moved: nothing is done
    assert session.document.undo.count() == 1
    session.document.undo.undo()
    assert lane_of(timeline).cues == before.cues
    session.document.undo.redo()
    assert lane_of(timeline).cues == moved.cues


def test_undo_while_a_boundary_is_dragged_cancels_the_drag(timeline: Timeline) -> None:
    session = timeline._session
    drag(timeline, at(timeline, 2.0), at(timeline, 2.4))
    QTest.mousePress(timeline, LEFT, PLAIN, at(timeline, 5.0))
    QTest.mouseMove(timeline, at(timeline, 6.0))
    session.document.undo.undo()
    QTest.mouseMove(timeline, at(timeline, 6.5))
    timeline.grab()
    QTest.mouseRelease(timeline, LEFT, PLAIN, at(timeline, 6.5))
    assert lane_of(timeline).cues == CUES and session.document.undo.index() == 0


def test_a_boundary_stops_at_its_neighbours(timeline: Timeline) -> None:
    drag(timeline, at(timeline, 3.0), at(timeline, 9.0))
    assert lane_of(timeline).cues[1].stop_s == 4.0
    drag(timeline, at(timeline, 1.0), at(timeline, 6.0))
    assert 1.9 < lane_of(timeline).cues[0].start_s < 2.0


def test_inside_a_block_a_press_scrubs_and_a_double_click_selects(timeline: Timeline) -> None:
    session = timeline._session
    QTest.mouseClick(timeline, LEFT, PLAIN, at(timeline, 2.5))
    assert session.view.playhead == 75 and session.document.undo.count() == 0
    QTest.mouseDClick(timeline, LEFT, PLAIN, at(timeline, 2.5))
    assert session.view.selection == (60, 90) == lane_of(timeline).frames_of(1, FPS)


def test_the_pointer_shows_what_a_press_takes_hold_of(timeline: Timeline) -> None:
    QTest.mouseMove(timeline, at(timeline, 2.0))
    assert timeline.cursor().shape() == Qt.CursorShape.SplitHCursor
    QTest.mouseMove(timeline, at(timeline, 2.5))
    assert timeline.cursor().shape() == Qt.CursorShape.ArrowCursor
    assert "AA1: open" in timeline.told_at(QPointF(at(timeline, 2.5)))


def test_a_menu_changes_what_is_said(qtbot: QtBot, timeline: Timeline) -> None:
    place = at(timeline, 2.5)
    event = QContextMenuEvent(QContextMenuEvent.Reason.Mouse, place, timeline.mapToGlobal(place))
    QApplication.sendEvent(timeline, event)
    menu = timeline.visemes.menu
    assert menu is not None and [action.text() for action in menu.actions()][: len(NAMES)] == [t for _, t in choices()]
    menu.actions()[class_of("UW")].trigger()
    menu.close()
    assert lane_of(timeline).cues[1].label == "uw" and timeline._session.document.undo.undoText() == "say uw"


def test_a_name_is_typed_with_or_without_times(qtbot: QtBot, timeline: Timeline) -> None:
    session = timeline._session
    timeline.visemes.type_name(1)
    QTest.keyClicks(timeline.visemes.entry, "OW1")  # over the name, which is selected
    QTest.keyClick(timeline.visemes.entry, Qt.Key.Key_Return)
    assert lane_of(timeline).cues[1] == Cue(2.0, 3.0, "OW1")
    timeline.visemes.type_name(1)
    timeline.visemes.entry.selectAll()
    QTest.keyClicks(timeline.visemes.entry, "r 2.25 3.5")
    QTest.keyClick(timeline.visemes.entry, Qt.Key.Key_Return)
    assert (
        lane_of(timeline).cues[:2] == (Cue(1.0, 2.25, "M"), Cue(2.25, 3.5, "r")) and session.document.undo.count() == 2
    )


@pytest.mark.parametrize("typed", ["quux", "M 1", "M 3 2", "M a b", ""])
def test_what_cannot_be_said_is_one_sentence_and_changes_nothing(qtbot: QtBot, timeline: Timeline, typed: str) -> None:
    before = lane_of(timeline)
    timeline.visemes.type_name(1)
    timeline.visemes.entry.clear()
    QTest.keyClicks(timeline.visemes.entry, typed)
    with qtbot.waitSignal(timeline.visemes.failed):
        QTest.keyClick(timeline.visemes.entry, Qt.Key.Key_Return)
    assert lane_of(timeline) is before and timeline._session.document.undo.count() == 0


def test_escape_cancels_what_is_typed(qtbot: QtBot, timeline: Timeline) -> None:
    timeline.visemes.type_name(1)
    entry = timeline.visemes.entry
    QTest.keyClicks(entry, "T")
    QTest.keyClick(entry, Qt.Key.Key_Escape)
    assert timeline.visemes.entry is None
    assert lane_of(timeline).cues == CUES
    assert timeline._session.document.undo.count() == 0


def test_all_is_shifted_by_what_is_typed_or_to_the_playhead(timeline: Timeline) -> None:
    timeline.visemes.type_shift()
    QTest.keyClicks(timeline.visemes.entry, "-0.5")
    QTest.keyClick(timeline.visemes.entry, Qt.Key.Key_Return)
    assert lane_of(timeline).times_s[0].tolist() == [0.5, 1.5]
    timeline._session.view.move_playhead(120)
    timeline.visemes._begin_at_playhead(lane_of(timeline), 1)
    assert lane_of(timeline).times_s[1, 0] == pytest.approx(4.0) and lane_of(timeline).cues == CUES


def bar(timeline: Timeline) -> list[QColor]:
    """The strong edge of the lane, pixel by pixel."""
    timeline._session.view.move_playhead(299)
    image = timeline.grab().toImage().convertToFormat(QImage.Format.Format_RGB32)
    box = timeline.lane_box("visemes").adjusted(0, 3, 0, -3)
    return [image.pixelColor(x, round(box.bottom() - BAR_PX / 2)) for x in range(100, 700)]


@pytest.mark.parametrize("colours", [DARK, LIGHT])
def test_a_block_has_the_colour_of_what_the_mouth_does(timeline: Timeline, colours: object) -> None:
    timeline.paint_with(colours)
    shown, groups = bar(timeline), list(GROUPS)
    per_s = 600 / 300 * FPS
    for time_s, group in ((1.5, "lips together"), (2.5, "open"), (4.5, "lip on teeth")):
        assert shown[round(time_s * per_s)] == QColor(group_colours(colours)[groups.index(group)])
    assert shown[round(0.5 * per_s)] == shown[round(3.5 * per_s)]  # pauses are left empty


def test_far_away_colours_mix_by_how_long_each_is_said(timeline: Timeline) -> None:
    """A pixel that holds many cues has the mean of their colours, wherever the view begins."""
    session = timeline._session
    cues = [Cue(i * 0.01, (i + 1) * 0.01, "M" if i % 4 else "F") for i in range(1000)]
    session.document.set_visemes(attached(cues, "fast"))
    session.view.set_range(0, 300)
    mixed = bar(timeline)[5:-5]
    names = group_colours(DARK)
    lips, teeth = QColor(names[1]), QColor(names[2])
    for part in (QColor.red, QColor.green, QColor.blue):
        mean = np.mean([part(pixel) for pixel in mixed])
        assert mean == pytest.approx(0.75 * part(lips) + 0.25 * part(teeth), abs=4)


def test_without_visemes_there_is_no_lane(timeline: Timeline) -> None:
    session, height = timeline._session, timeline.sizeHint().height()
    session.document.set_visemes(None)
    assert timeline.lane_box("visemes").isEmpty() and timeline.sizeHint().height() < height
    assert timeline.visemes.edge_at(300) is None and timeline.visemes.tool_tip(300) == ""


FLAGS = (
    Flag("lost", 30, 60, 0.9, "No face."),
    Flag("spike", 100, 101, 0.5, "A spike."),
    Flag("spike", 102, 103, 0.3, "Another spike."),
    Flag("frozen", 200, 210, 0.25, "Still."),
)


def test_a_mark_is_clicked_to_go_there_and_shows_why(timeline: Timeline) -> None:
    session = timeline._session
    session.document.set_flags(FLAGS)
    timeline.grab()
    QTest.mouseClick(timeline, LEFT, PLAIN, at(timeline, 30 / FPS, "flags"))
    assert session.view.playhead == 30 and session.view.selection is None
    QTest.mouseMove(timeline, at(timeline, 200 / FPS, "flags"))
    assert timeline.cursor().shape() == Qt.CursorShape.PointingHandCursor
    assert timeline.told_at(QPointF(at(timeline, 200 / FPS, "flags"))) == "Still."
    QTest.mouseClick(timeline, LEFT, PLAIN, at(timeline, 150 / FPS, "flags"))
    assert session.view.playhead == 150


def test_marks_that_would_touch_are_one_until_they_have_room(timeline: Timeline) -> None:
    session = timeline._session
    session.document.set_flags(FLAGS)
    timeline.grab()
    marks = {mark.flag.start: mark.others for mark in timeline._flags.marks}
    assert marks == {30: 0, 100: 1, 200: 0}
    assert "1 more here: zoom in" in timeline.told_at(QPointF(at(timeline, 100 / FPS, "flags")))
    session.view.set_range(95, 125)
    timeline.grab()
    assert [mark.flag.start for mark in timeline._flags.marks] == [100, 102]
    session.view.set_range(110, 150)
    timeline.grab()
    assert timeline._flags.marks == []
    session.view.set_range(95, 125)
    timeline.grab()
    places = [mark.x for mark in timeline._flags.marks]
    assert min(np.diff(places)) >= APART_PX


def test_heavier_flags_are_drawn_larger_and_in_another_colour(timeline: Timeline) -> None:
    timeline._session.document.set_flags(FLAGS)
    image = timeline.grab().toImage()
    box = timeline.lane_box("flags")
    shown = []
    for flag in (FLAGS[0], FLAGS[1], FLAGS[3]):
        x = round(timeline.x_of(flag.start))
        around = [
            image.pixelColor(x + dx, y).name()
            for dx in range(-5, 6)
            for y in range(int(box.top()), int(box.bottom()) - 3)
        ]
        inked = [name for name in around if name != image.pixelColor(x - 12, int(box.top()) + 1).name()]
        shown.append((len(inked), max(set(inked), key=inked.count)))
    sizes, shades = zip(*shown, strict=True)
    assert sizes[0] > sizes[1] > sizes[2] and len(set(shades)) == 3


def test_the_flags_lane_says_when_there_is_nothing(timeline: Timeline) -> None:
    session = timeline._session
    pictures = []
    for flags in (None, (), FLAGS):
        session.document.set_flags(flags)  # type: ignore[arg-type]
        pictures.append(timeline.grab().toImage())
    assert pictures[0] != pictures[1] != pictures[2]


@pytest.mark.parametrize("notches", [3, -3])
def test_zoom_and_pan_leave_the_selection(timeline: Timeline, notches: int) -> None:
    session = timeline._session
    session.view.select((60, 90))
    for factor in (1.5, 8.0, 0.01):
        session.view.zoom(factor, 75)
    session.view.set_range(200, 260)
    wheel = QPointF(at(timeline, 2.0, "flags"))
    event = QWheelEvent(
        wheel,
        wheel,
        QPoint(0, 0),
        QPoint(0, 120 * notches),
        Qt.MouseButton.NoButton,
        PLAIN,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    QApplication.sendEvent(timeline, event)
    assert session.view.selection == (60, 90)
