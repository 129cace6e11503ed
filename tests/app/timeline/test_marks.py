from __future__ import annotations

import pytest
from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor

from app.theme import DARK
from app.timeline.marks import APART_PX, NOTE_PX, draw_marks, draw_ranges, lanes
from engine.project import Marks, Note, Pin
from tests.app.pens import LETTER_PX, Pen

PLACE = QRectF(100, 50, 500, 18), (0.0, 100.0)  # five pixels to a frame


def a_note(frame: int, text: str = "lips", **more: object) -> Note:
    return Note(frame, "Ana", "2025-01-02T03:04:05Z", text, **more)  # type: ignore[arg-type]


def a_pin(frame: int, start: int | None = None, stop: int | None = None) -> Pin:
    return Pin(frame, {"jawOpen": 0.5}, frame if start is None else start, frame + 1 if stop is None else stop)


def drawn(marks: Marks, name: str, place: tuple[QRectF, tuple[float, float]] = PLACE) -> Pen:
    pen = Pen()
    draw_marks(pen, marks, name, place, DARK)  # type: ignore[arg-type]
    return pen


def test_there_is_a_lane_for_what_there_is() -> None:
    assert lanes(Marks()) == []
    assert lanes(Marks(notes=(a_note(3),))) == ["notes"] and lanes(Marks(pins=(a_pin(3),))) == ["pins"]
    assert lanes(Marks(notes=(a_note(3),), pins=(a_pin(3),))) == ["pins", "notes"]


def test_a_pin_is_a_diamond_on_its_frame_with_a_line_over_its_range() -> None:
    pen = drawn(Marks(pins=(a_pin(50, 40, 61),)), "pins")
    ((begin, end),) = pen.of("drawLine")
    assert (begin.x(), end.x(), begin.y(), end.y()) == (300, 400, 59, 59)
    ((corners,),) = pen.of("drawPolygon")
    assert [(point.x(), point.y()) for point in corners] == [(345, 59), (350, 54), (355, 59), (350, 64)]


@pytest.mark.parametrize(("frames", "shown"), [((50, 51), 2), ((50, 50), 1), ((100, 101, 102), 2)])
def test_pins_that_cannot_be_told_apart_or_are_out_of_sight_are_left_out(frames: tuple[int, ...], shown: int) -> None:
    assert len(drawn(Marks(pins=tuple(a_pin(frame) for frame in frames)), "pins").of("drawPolygon")) == shown


def test_marks_are_apart_by_their_least_distance() -> None:
    box = QRectF(100, 50, 500, 18)
    for span, shown in ((500 / APART_PX, 2), (500 / APART_PX + 20, 1)):
        pen = drawn(Marks(notes=(a_note(50), a_note(51))), "notes", (box, (0.0, span)))
        assert len(pen.of("drawEllipse")) == shown


def test_a_note_is_a_dot_with_its_text_as_far_as_the_next() -> None:
    pen = drawn(Marks(notes=(a_note(10, "a" * 100), a_note(30, "b" * 100), a_note(31, "c"))), "notes")
    dots = [point.x() for point, *_ in pen.of("drawEllipse")]
    assert dots == [150, 250, 255]
    rooms = [(box.left(), box.width()) for box, *_ in pen.of("drawText")]
    assert rooms == [(158, 100 - 14), (263, NOTE_PX)]  # there is none beside the second, whose text would be cut
    assert pen.texts == ["a" * int((100 - 14) / LETTER_PX), "c"]


def test_a_note_on_several_frames_has_a_line_to_its_last() -> None:
    ((begin, end), (_, up)) = drawn(Marks(notes=(a_note(10, frames=21),)), "notes").of("drawLine")
    assert (begin.x(), end.x()) == (150, 250) and (up.x(), up.y()) == (250, begin.y() - 5)
    assert not drawn(Marks(notes=(a_note(10),)), "notes").of("drawLine")


def test_a_range_within_another_and_out_of_sight_is_not_drawn() -> None:
    notes = (a_note(10, frames=40), a_note(20, frames=10), a_note(110, frames=20))
    assert len(drawn(Marks(notes=notes), "notes").of("drawLine")) == 2  # one line and its end
    assert len(drawn(Marks(notes=(a_note(-50, frames=60),)), "notes").of("drawLine")) == 2


@pytest.mark.parametrize(("start", "stop", "left", "width"), [(10, 20, 147.5, 50), (10, 10, 147.5, 2), (0, 1, 97.5, 5)])
def test_ranges_are_blocks_over_their_frames(start: int, stop: int, left: float, width: float) -> None:
    pen = Pen()
    draw_ranges(pen, [(start, stop)], PLACE, DARK)  # type: ignore[arg-type]
    ((box, colour),) = pen.of("fillRect")
    assert (box.left(), box.width(), box.top(), box.height()) == (left, width, 54, 10)
    assert colour == QColor(DARK.lanes[5])


def test_ranges_out_of_sight_are_not_drawn() -> None:
    pen = Pen()
    draw_ranges(pen, [(-20, -5), (101, 110), (-20, 1), (100, 101)], PLACE, DARK)  # type: ignore[arg-type]
    assert len(pen.of("fillRect")) == 2
