"""What lies under a place of the timeline, without a widget."""

from __future__ import annotations

import pytest

from app.timeline.flags import Mark
from app.timeline.hits import FLAG_NEAR_PX, NEAR_PX, Grip, Layout, hit
from engine.project import Marks, Note, Pin, Span
from engine.quality import Flag

LAYOUT = Layout(
    100.0,
    600.0,
    (50.0, 350.0),
    26.0,
    (("audio", 35.0), ("visemes", 30.0), ("spans", 22.0), ("flags", 18.0), ("pins", 18.0)),
)
RULER_Y, AUDIO_Y, VISEMES_Y, SPANS_Y, FLAGS_Y, PINS_Y = 10.0, 40.0, 75.0, 100.0, 120.0, 140.0
PIN = Pin(200, {"jawOpen": 0.5}, 190, 210)
MARKS = Marks(spans=(Span(80, 90), Span(85, 99)), pins=(PIN,), notes=(Note(60, "Ana", "", "here"),))
FLAG = Mark(LAYOUT.x_of(120), Flag("held", 120, 125, 0.5, "Still."), 2)


def at(frame: float, y: float) -> object:
    return hit(LAYOUT, MARKS, [FLAG], x=LAYOUT.x_of(frame), y=y)


def test_places_and_frames_are_each_other_s_inverse() -> None:
    assert LAYOUT.x_of(50) == 100 and LAYOUT.x_of(350) == 700
    for frame in (-3.0, 50.0, 123.4, 350.0, 999.0):
        assert LAYOUT.frame_at(LAYOUT.x_of(frame)) == pytest.approx(frame)


def test_each_lane_begins_where_the_one_above_ends() -> None:
    assert LAYOUT.rows()["audio"] == (26, 61) and LAYOUT.height_px == LAYOUT.rows()["pins"][1] == 149
    names = [LAYOUT.lane_at(y) for y in (0, 26, 26.5, 61, 61.5, 149, 149.5)]
    assert names == ["", "", "audio", "audio", "visemes", "pins", ""]


@pytest.mark.parametrize(
    ("frame", "y", "selects", "grip", "kind", "goes_to"),
    [
        (150.2, RULER_Y, False, Grip.PLAYHEAD, "time", 150),
        (150.2, RULER_Y, True, Grip.RANGE, "time", 150),
        (150.2, AUDIO_Y, False, Grip.SOUND, "audio", 150),
        (150.2, VISEMES_Y, False, Grip.VISEME, "time", 150),
        (150.2, VISEMES_Y, True, Grip.RANGE, "time", 150),
        (150.2, SPANS_Y, False, Grip.RANGE, "time", 150),
        (87.0, SPANS_Y, True, Grip.SPAN, "span", 80),  # the first of two
        (95.0, SPANS_Y, False, Grip.SPAN, "span", 85),
        (121.0, FLAGS_Y, False, Grip.FLAG, "flag", 120),
        (150.2, FLAGS_Y, False, Grip.PLAYHEAD, "time", 150),
        (202.0, PINS_Y, False, Grip.MARK, "pin", 200),
        (202.0, FLAGS_Y, False, Grip.PLAYHEAD, "time", 202),
    ],
)
def test_a_press_takes_hold_of_what_lies_there(
    frame: float, y: float, selects: bool, grip: Grip, kind: str, goes_to: int
) -> None:
    under = at(frame, y)
    assert (under.grip(selects=selects), under.kind, under.goes_to) == (grip, kind, goes_to)


def test_flags_and_pins_are_hit_no_further_than_they_reach() -> None:
    for x, y, reach, found in ((FLAG.x, FLAGS_Y, FLAG_NEAR_PX, "flag"), (LAYOUT.x_of(200), PINS_Y, NEAR_PX, "pin")):
        for away, kind in ((reach - 0.01, found), (reach + 0.01, "time")):
            assert hit(LAYOUT, MARKS, [FLAG], x=x + away, y=y).kind == kind
            assert hit(LAYOUT, MARKS, [FLAG], x=x - away, y=y).kind == kind


def test_of_two_flags_the_nearer_one_is_hit() -> None:
    other = Mark(FLAG.x + 4, Flag("held", 122, 123, 0.5, "Too."), 0)
    assert hit(LAYOUT, MARKS, [FLAG, other], x=FLAG.x + 3, y=FLAGS_Y).flag is other
    assert hit(LAYOUT, MARKS, [FLAG, other], x=FLAG.x + 1, y=FLAGS_Y).flag is FLAG
    assert hit(LAYOUT, MARKS, [FLAG, other], x=FLAG.x, y=FLAGS_Y).sentence == "Still."
