from __future__ import annotations

import pytest
from PySide6.QtCore import QRectF

from app.theme import DARK
from app.timeline.spans import GAP_PX, NAME_PX, SpanLane
from engine.project import Span
from tests.app.pens import LETTER_PX, Pen

BOX, VIEW = QRectF(100, 50, 500, 30), (0.0, 100.0)  # five pixels to a frame


def drawn(*spans: Span, lane: SpanLane | None = None, view: tuple[float, float] = VIEW) -> Pen:
    pen = Pen()
    (lane or SpanLane()).draw(pen, spans, BOX, view, DARK)  # type: ignore[arg-type]
    return pen


def boxes(pen: Pen) -> list[tuple[float, float]]:
    return [(box.left(), box.width()) for (box,) in pen.of("drawRect")[::2]]  # each is tinted and hatched


def test_a_span_is_a_box_around_its_frames() -> None:
    (tinted,), (hatched,) = drawn(Span(10, 20)).of("drawRect")
    assert tinted == hatched == QRectF(100 + 9.5 * 5, 53, 50, 23)
    assert boxes(drawn(Span(10, 20), view=(5, 55))) == [(100 + 4.5 * 10, 100)]


def test_no_span_is_thinner_than_can_be_seen() -> None:
    assert boxes(drawn(Span(500, 501), view=(0, 1000))) == [(100 + 499.5 / 2, 3.0)]


@pytest.mark.parametrize(
    ("span", "seen"), [(Span(-20, -1), False), (Span(-20, 1), True), (Span(100, 120), True), (Span(101, 120), False)]
)
def test_spans_beyond_the_view_are_not_drawn(span: Span, seen: bool) -> None:
    assert bool(boxes(drawn(span))) == seen


def test_spans_that_could_not_be_told_from_the_one_before_are_left_out() -> None:
    def view(gap_px: float) -> Pen:
        per = 500 / 4000  # pixels to a frame
        second = round(108 + gap_px / per)
        return drawn(Span(100, 108), Span(second - 8, second), view=(0, 4000))

    assert len(boxes(view(GAP_PX))) == 2 and len(boxes(view(GAP_PX - 1))) == 1


def test_a_box_has_its_name_where_that_fits() -> None:
    for region, kind, name in (("lower", "marked", "lower"), ("face", "lost", "lost")):
        needed = LETTER_PX * len(name) + 14
        for frames in (int(needed / 5), int(needed / 5) + 1):
            pen = drawn(Span(10, 10 + frames, region, kind))
            assert pen.texts == [name] * (frames * 5 > needed and frames * 5 > NAME_PX)
    pen = drawn(Span(10, 30, "lower"))
    ((label, *_),) = pen.of("drawText")
    assert label.center().x() == 100 + 19.5 * 5 and label.width() == LETTER_PX * 5 + 10


def test_other_spans_are_learnt_anew() -> None:
    lane, few = SpanLane(), (Span(10, 20),)
    assert boxes(drawn(*few, lane=lane)) == boxes(drawn(*few))
    assert len(boxes(drawn(Span(30, 40), Span(60, 70), lane=lane))) == 2
    assert not boxes(drawn(lane=lane))
