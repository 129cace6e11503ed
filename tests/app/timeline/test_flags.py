from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QRectF

from app.theme import DARK
from app.timeline.flags import APART_PX, NOTABLE, SERIOUS, FlagLane, Mark
from engine.quality import Flag
from tests.app.pens import Pen

BOX = QRectF(100, 50, 500, 18)


def a_flag(start: int, weight: float = 0.5, frames: int = 1, kind: str = "pop") -> Flag:
    return Flag(kind, start, start + frames, weight, f"At {start}.")


def drawn(*flags: Flag, view: tuple[float, float] = (0.0, 100.0)) -> tuple[Pen, list[Mark]]:
    pen, lane = Pen(), FlagLane()
    lane.draw(pen, flags, BOX, view, DARK)  # type: ignore[arg-type]
    return pen, lane.marks


def test_a_flag_is_where_its_first_frame_is() -> None:
    _, marks = drawn(a_flag(10), a_flag(60), view=(5, 105))
    assert [mark.x for mark in marks] == [100 + 25, 100 + 275] and [mark.others for mark in marks] == [0, 0]


def test_flags_that_lie_close_are_the_heaviest_of_them_wherever_one_looks() -> None:
    rng = np.random.default_rng(0)
    flags = tuple(a_flag(start, float(rng.random())) for start in sorted(rng.integers(0, 900, 80).tolist()))
    per_frame = 0.5
    for first in (0.0, 3.0, 200.5):
        _, marks = drawn(*flags, view=(first, first + 500 / per_frame))
        cells: dict[int, list[Flag]] = {}
        for flag in flags:
            if first - APART_PX / per_frame <= flag.start < first + 1001:
                cells.setdefault(int(flag.start * per_frame // APART_PX), []).append(flag)
        assert [mark.flag.weight for mark in marks] == [max(f.weight for f in each) for each in cells.values()]
        assert [mark.others for mark in marks] == [len(each) - 1 for each in cells.values()]


def test_a_mark_tells_how_many_others_it_stands_for() -> None:
    assert Mark(0.0, a_flag(3), 0).sentence == "At 3."
    assert Mark(0.0, a_flag(3), 2).sentence == "At 3. 2 more here: zoom in."


@pytest.mark.parametrize(
    ("weight", "corners"), [(SERIOUS, 3), (SERIOUS - 0.01, 4), (NOTABLE, 4), (NOTABLE - 0.01, 0), (1.0, 3), (0.2, 0)]
)
def test_what_weighs_more_has_another_shape(weight: float, corners: int) -> None:
    pen, _ = drawn(a_flag(50, weight))
    assert [len(points) for (points,) in pen.of("drawPolygon")] == [corners] * (corners > 0)
    assert len(pen.of("drawEllipse")) == (corners == 0)


def test_a_line_tells_how_long_it_is_and_ends_with_the_lane() -> None:
    for frames, shown in ((2, False), (3, True)):  # five pixels to a frame: as long as marks are apart
        lines = drawn(a_flag(50, frames=frames))[0].of("drawLine")
        assert len(lines) == shown
    ((begin, end),) = drawn(a_flag(50, frames=11))[0].of("drawLine")
    assert (begin.x(), end.x(), begin.y()) == (350, 400, 66)
    ((_, end),) = drawn(a_flag(90, frames=80))[0].of("drawLine")
    assert end.x() == 600


def test_before_anybody_looked_and_where_nothing_was_found_it_says_so() -> None:
    assert drawn()[0].texts == ["no flags"] and not drawn(a_flag(3))[0].texts
    pen, lane = Pen(), FlagLane()
    lane.draw(pen, None, BOX, (0, 100), DARK)  # type: ignore[arg-type]
    assert pen.texts == ["looking…"] and lane.marks == []
