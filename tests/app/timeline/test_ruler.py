from __future__ import annotations

import pytest

from app.theme import DARK
from app.timeline.hits import Layout
from app.timeline.ruler import LABEL_PX, STEPS_FRAMES, STEPS_S, draw_ticks
from engine.take import timecode
from tests.app.pens import LETTER_PX, Pen

LEFT, FPS = 100.0, 10.0


def ticks(width: float, view: tuple[float, float], *, in_frames: bool, fps: float = FPS) -> Pen:
    pen = Pen()
    draw_ticks(pen, Layout(LEFT, width, view, 24.0, ()), fps, DARK, in_frames=in_frames)  # type: ignore[arg-type]
    return pen


@pytest.mark.parametrize(("width", "step"), [(10.0 * LABEL_PX, 10), (10.0 * LABEL_PX - 1, 20), (5.0 * LABEL_PX, 20)])
def test_frames_are_told_as_close_as_their_labels_have_room(width: float, step: int) -> None:
    pen = ticks(width, (0, 100), in_frames=True)
    places = [LEFT + frame / 100 * width for frame in range(0, 101, step)]
    assert [line for line in pen.of("drawLine")] == [(int(x), 20, int(x), 24) for x in places]
    assert pen.texts == [str(frame) for frame in range(step, 100, step)]  # those at the ends would be cut
    for (box, *_), x in zip(pen.of("drawText"), places[1:-1], strict=True):
        assert (box.center().x(), box.width(), box.top()) == (x, 100, 4)


def test_seconds_are_told_as_timecode() -> None:
    pen = ticks(10.0 * LABEL_PX, (0, 100), in_frames=False)
    assert pen.texts == [timecode(second, FPS) for second in range(1, 10)]


def test_thousands_of_frames_are_told_with_their_comma_and_no_step_is_too_large() -> None:
    assert ticks(840.0, (0, 40_000), in_frames=True).texts[0] == "5,000"
    widest = ticks(100.0, (0, 10 * STEPS_FRAMES[-1]), in_frames=True)
    assert len(widest.of("drawLine")) == 11
    assert len(ticks(100.0, (0, 10 * STEPS_S[-1] * FPS), in_frames=False).of("drawLine")) == 11


def test_a_label_is_there_as_soon_as_all_of_it_is() -> None:
    half = LETTER_PX  # of two figures
    for first, there in ((20 - half / 10, True), (20 - half / 10 + 0.1, False)):
        assert ("20" in ticks(1000.0, (first, first + 100), in_frames=True).texts) == there
    for last, there in ((80 + half / 10, True), (80 + half / 10 - 0.1, False)):
        assert ("80" in ticks(1000.0, (last - 100, last), in_frames=True).texts) == there
