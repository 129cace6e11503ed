from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor, QImage, QPainter
from pytestqt.qtbot import QtBot

from app.theme import DARK
from app.timeline.visemes import (
    BAR_PX,
    BLOCK_PX,
    ROOM_PX,
    SILENT,
    VisemeStrip,
    _across,
    _around,
    _draw_name,
    choices,
    describe,
    group_colours,
    group_of,
    icon,
)
from engine.speech.lane import GROUPS, VisemeLane, attached
from engine.speech.visemes import NAMES, Cue
from tests.app.pens import LETTER_PX, Pen

CUES = (Cue(1.0, 2.0, "M"), Cue(2.0, 3.0, "AA1"), Cue(4.0, 5.0, "F"))


def a_lane(*cues: Cue) -> VisemeLane:
    return attached(cues or CUES, "a.TextGrid")


def test_a_group_has_a_colour_of_its_own_and_silence_a_faint_one() -> None:
    colours = group_colours(DARK)
    assert len(set(colours)) == len(GROUPS) and colours[group_of("")] == DARK.faint
    assert group_of("M") == group_of("B") != group_of("AA1")


def test_a_cue_is_told_by_its_group_and_its_times() -> None:
    group = list(GROUPS)[group_of("AA1")]
    assert describe(a_lane(), 1).startswith(f"AA1: {group}, 2.00 to 3.00 s.")
    assert describe(a_lane(Cue(0.0, 1.0, " ")), 0).startswith("silence: ")


def test_each_class_can_be_chosen_and_has_a_swatch(qtbot: QtBot) -> None:
    assert [name for name, _ in choices()] == list(NAMES)
    assert all(title.startswith(name) for name, title in choices())
    for name, _ in choices():
        shade = icon(name, DARK).pixmap(12, 12).toImage().pixelColor(6, 6)
        assert shade == QColor(group_colours(DARK)[group_of(name)])


def shades(lane: VisemeLane, edges_s: np.ndarray) -> list[tuple[int, int, int, int]]:
    strip = VisemeStrip()
    strip._learn(lane)
    picture = strip._picture(edges_s, DARK)
    assert (picture.width(), picture.height()) == (len(edges_s) - 1, 1)
    pixels = [picture.pixel(at, 0) for at in range(picture.width())]
    return [(pixel >> 24 & 255, pixel >> 16 & 255, pixel >> 8 & 255, pixel & 255) for pixel in pixels]


def test_a_column_is_the_mixture_of_what_is_said_in_it(qtbot: QtBot) -> None:
    edges = np.array([0.0, 0.5, 1.0, 1.25, 1.75, 2.5, 3.5, 4.0, 6.0])
    for shade, start, stop in zip(shades(a_lane(), edges), edges, edges[1:], strict=False):
        share = {cue.label: max(0.0, min(stop, cue.stop_s) - max(start, cue.start_s)) / (stop - start) for cue in CUES}
        colour = {label: QColor(group_colours(DARK)[group_of(label)]) for label in share}
        wanted = [255 * sum(share.values())]
        for part in ("red", "green", "blue"):
            wanted.append(sum(share[label] * getattr(colour[label], part)() for label in share))
        assert np.abs(np.array(shade) - wanted).max() <= 1.0


def test_silence_is_drawn_weakly(qtbot: QtBot) -> None:
    ((alpha, *_),) = shades(a_lane(Cue(0.0, 1.0, "")), np.array([0.25, 0.75]))
    assert alpha == pytest.approx(255 * SILENT, abs=1)


def test_times_go_across_the_box_as_across_what_it_shows() -> None:
    box = QRectF(100, 0, 500, 20)
    assert _across(box, (2.0, 12.0), np.array([2.0, 7.0])) == (100, 350)
    assert _around(a_lane(), [1]) == (2.0, 4.0)
    assert _around(a_lane(), [1, 2]) == (2.0, 5.0 + 1e3)
    assert _around(a_lane(), [0]) == (1.0 - 1e3, 2.0)


@pytest.mark.parametrize(
    ("room", "written"), [(3, "AA1"), (2.5, "AA"), (2, "AA"), (1.9, "")], ids=["whole", "no stress", "just", "none"]
)
def test_a_name_loses_its_stress_first_where_room_is_scarce(room: float, written: str) -> None:
    pen = Pen()
    _draw_name(pen, "AA1", QRectF(0, 0, 500, 20), (100, 100 + LETTER_PX * room + ROOM_PX), DARK)  # type: ignore[arg-type]
    assert pen.texts == [written] * bool(written)
    assert [begin.x() for begin, _ in pen.of("drawLine")] == [100, 100 + LETTER_PX * room + ROOM_PX]


def test_a_name_stays_in_sight_while_its_block_is() -> None:
    pen = Pen()
    _draw_name(pen, "M", QRectF(100, 0, 500, 20), (-900, 200), DARK)  # type: ignore[arg-type]
    ((box, *_),) = pen.of("drawText")
    assert (box.left(), box.right(), box.height()) == (100, 200, 20 - BAR_PX)


@pytest.mark.parametrize(("width", "named"), [(3 * BLOCK_PX * 10, True), (3 * BLOCK_PX - 1, False)])
def test_boundaries_are_drawn_where_blocks_are_wide_enough(
    qtbot: QtBot, width: int, named: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    written: list[str] = []
    monkeypatch.setattr(
        "app.timeline.visemes._draw_name", lambda painter, label, box, ends, colours: written.append(label)
    )
    picture = QImage(width, 20, QImage.Format.Format_ARGB32)
    painter = QPainter(picture)
    VisemeStrip().draw(painter, a_lane(), (QRectF(0, 0, width, 20), (0.0, 6.0)), DARK)
    painter.end()
    assert written == ["M", "AA1", "F"] * named
