"""The timeline under real mouse and wheel events: the ruler, the lane of spans, the sound and the marks."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QContextMenuEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.session import Session
from app.theme import DARK, GRID
from app.timeline.marks import LANE_PX
from app.timeline.panel import AUDIO_PX, HINTS, RULER_PX, SCROLL_PX, SLACK_PX, Timeline
from engine.formats.audio import Audio
from engine.project import Marks, Note, Pin, Reply, Span
from engine.take import SHAPES, Take

LEFT, RIGHT = Qt.MouseButton.LeftButton, Qt.MouseButton.RightButton
PLAIN, SHIFT = Qt.KeyboardModifier.NoModifier, Qt.KeyboardModifier.ShiftModifier
GUTTER, FPS = 100, 30.0
NOTE = Note(120, "Ana", "2025-01-02T03:04:05Z", "the lips", replies=(Reply("B", "t", "why?"),))


@pytest.fixture
def timeline(qtbot: QtBot) -> Iterator[Timeline]:
    shown = Timeline(Session(Take(np.zeros((300, len(SHAPES))), FPS)), DARK, gutter_px=GUTTER)
    qtbot.addWidget(shown)
    shown.resize(GUTTER + 600 + GRID + SCROLL_PX, 160)
    shown._session.view.set_range(0, 300)
    with qtbot.waitExposed(shown):
        shown.show()
    yield shown


def at(timeline: Timeline, frame: float, lane: str = "") -> QPoint:
    y = timeline.lane_box(lane).center().y() if lane else RULER_PX / 2
    return QPoint(round(timeline.x_of(frame)), round(y))


def drag(timeline: Timeline, start: QPoint, stop: QPoint, keys: Qt.KeyboardModifier = PLAIN) -> None:
    QTest.mousePress(timeline, LEFT, keys, start)
    QTest.mouseMove(timeline, stop)
    QTest.mouseRelease(timeline, LEFT, keys, stop)


def turned(timeline: Timeline, turn: QPoint, keys: Qt.KeyboardModifier = PLAIN, frame: float = 75) -> None:
    place = QPointF(at(timeline, frame))
    wheel = QWheelEvent(
        place, place, QPoint(), turn, Qt.MouseButton.NoButton, keys, Qt.ScrollPhase.NoScrollPhase, False
    )
    QApplication.sendEvent(timeline, wheel)


def test_the_ruler_is_scrubbed_on(timeline: Timeline) -> None:
    view = timeline._session.view
    QTest.mousePress(timeline, LEFT, PLAIN, at(timeline, 100))
    assert view.playhead == 100
    QTest.mouseMove(timeline, at(timeline, 150))
    assert view.playhead == 150
    QTest.mouseRelease(timeline, LEFT, PLAIN, at(timeline, 150))
    QTest.mouseMove(timeline, at(timeline, 200))
    QTest.mousePress(timeline, RIGHT, PLAIN, at(timeline, 250))
    assert view.playhead == 150 and view.selection is None


@pytest.mark.parametrize(("start", "stop"), [(60, 89), (89, 60)])
def test_with_shift_frames_are_selected_and_become_no_span(
    qtbot: QtBot, timeline: Timeline, start: int, stop: int
) -> None:
    with qtbot.assertNotEmitted(timeline.marked):
        drag(timeline, at(timeline, start), at(timeline, stop), SHIFT)
    assert timeline._session.view.selection == (60, 90)


def test_in_the_lane_of_spans_frames_are_marked_and_a_click_clears_the_selection(
    qtbot: QtBot, timeline: Timeline
) -> None:
    with qtbot.waitSignal(timeline.marked):
        drag(timeline, at(timeline, 60, "spans"), at(timeline, 89, "spans"))
    assert timeline._session.view.selection == (60, 90)
    with qtbot.assertNotEmitted(timeline.marked):
        QTest.mouseClick(timeline, LEFT, PLAIN, at(timeline, 200, "spans"))
    assert timeline._session.view.selection is None and timeline._session.view.playhead == 200


def test_a_span_is_chosen_by_a_click(timeline: Timeline) -> None:
    timeline._session.document.set_marks(Marks(spans=(Span(60, 90),)))
    QTest.mouseClick(timeline, LEFT, PLAIN, at(timeline, 75, "spans"))
    view = timeline._session.view
    assert view.selection == (60, 90) and view.playhead == 60
    QTest.mouseMove(timeline, at(timeline, 200, "spans"))
    assert view.selection == (60, 90)


def with_sound(timeline: Timeline) -> None:
    timeline._session.document.attach_audio(Audio(np.zeros(80_000, np.float32), 8_000))


def test_the_sound_is_dragged_along_with_the_pointer(qtbot: QtBot, timeline: Timeline) -> None:
    with_sound(timeline)
    document = timeline._session.document
    QTest.mousePress(timeline, LEFT, PLAIN, at(timeline, 100, "audio"))
    QTest.mouseMove(timeline, at(timeline, 100, "audio") + QPoint(SLACK_PX, 0))
    assert document.sliding is None
    QTest.mouseMove(timeline, at(timeline, 130, "audio"))
    assert document.offset_s("audio") == pytest.approx(1.0, abs=0.01) and document.offset_s("video") == 0.0
    with qtbot.waitSignal(timeline.slid):
        QTest.mouseRelease(timeline, LEFT, PLAIN, at(timeline, 130, "audio"))
    assert timeline._session.view.playhead == 0


def test_a_click_on_the_sound_goes_there(qtbot: QtBot, timeline: Timeline) -> None:
    with_sound(timeline)
    with qtbot.assertNotEmitted(timeline.slid):
        QTest.mouseClick(timeline, LEFT, PLAIN, at(timeline, 130, "audio"))
    assert timeline._session.view.playhead == 130 and timeline._session.document.sliding is None


def test_lanes_come_with_what_they_show(timeline: Timeline) -> None:
    bare = timeline.sizeHint().height()
    with_sound(timeline)
    assert timeline.sizeHint().height() == bare + AUDIO_PX and timeline.lane_box("audio").top() == RULER_PX
    pin = Pin(30, {"jawOpen": 0.5}, 20, 40)
    timeline._session.document.set_marks(Marks(pins=(pin,), notes=(NOTE,)))
    assert timeline.sizeHint().height() == bare + AUDIO_PX + 2 * LANE_PX
    assert timeline.lane_box("spans").left() == GUTTER and timeline.lane_box("spans").width() == 600
    assert timeline.lane_box("changes").isEmpty()


def test_a_view_without_any_of_the_notes_is_painted_too(timeline: Timeline) -> None:
    timeline._session.document.set_marks(Marks(notes=(NOTE,)))
    timeline._session.view.set_range(200, 260)
    assert not timeline.grab().isNull()


def test_a_menu_goes_to_what_it_is_for(qtbot: QtBot, timeline: Timeline) -> None:
    timeline._session.document.set_marks(Marks(spans=(Span(60, 90),), notes=(NOTE,)))
    for frame, lane, kind, goes_to, sentence in (
        (75, "spans", "span", 60, ""),
        (120, "notes", "note", 120, "the lips"),
        (200, "", "time", 200, ""),
    ):
        with qtbot.waitSignal(timeline.menu_wanted) as told:
            place = at(timeline, frame, lane)
            QApplication.sendEvent(timeline, QContextMenuEvent(QContextMenuEvent.Reason.Mouse, place, place))
        assert (told.args[0], told.args[2]) == (kind, sentence) and timeline._session.view.playhead == goes_to
    assert timeline._session.view.selection == (60, 90)


def test_what_lies_under_the_pointer_is_told(timeline: Timeline) -> None:
    with_sound(timeline)
    timeline._session.document.set_marks(Marks(notes=(NOTE,)))
    told = {lane: timeline.told_at(QPointF(at(timeline, 200, lane))) for lane in ("", "audio", "spans", "flags")}
    assert told == {lane: HINTS[lane] for lane in told}
    assert timeline.told_at(QPointF(at(timeline, 120, "notes"))) == "the lips\nAna, 2025-01-02T03:04:05Z\n↳ why?"
    QTest.mouseMove(timeline, at(timeline, 200, "audio"))
    assert timeline.cursor().shape() == Qt.CursorShape.SizeHorCursor
    QTest.mouseMove(timeline, at(timeline, 200))
    assert timeline.cursor().shape() == Qt.CursorShape.ArrowCursor


def test_the_wheel_zooms_around_the_pointer_and_pans_sideways(timeline: Timeline) -> None:
    view = timeline._session.view
    place = QPointF(at(timeline, 75))
    turned(timeline, QPoint(0, 240))
    assert view.range[1] - view.range[0] == pytest.approx(299 / 1.44, rel=0.01)
    assert timeline.frame_at(place.x()) == pytest.approx(75, abs=0.3)
    view.set_range(100, 200)
    turned(timeline, QPoint(0, 120), SHIFT)
    assert view.range == (pytest.approx(90), pytest.approx(190))
    turned(timeline, QPoint(-240, 0))
    assert view.range == (pytest.approx(110), pytest.approx(210))


def test_the_ruler_counts_in_what_is_asked_for(timeline: Timeline) -> None:
    before = timeline.grab().toImage()
    timeline.count_in_frames(True)
    assert timeline.in_frames and timeline.grab().toImage() != before
