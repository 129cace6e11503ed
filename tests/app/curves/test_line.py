from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QRectF
from PySide6.QtGui import QPen
from pytestqt.qtbot import QtBot

from app.curves.line import Line, _whole_parts
from tests.app.pens import Pen

NAN = np.nan


@pytest.mark.parametrize(
    ("values", "parts"),
    [
        ([1, 2, 3], [(0, 3)]),
        ([NAN, 1, 2], [(1, 3)]),
        ([1, NAN, 2, 3, NAN], [(0, 1), (2, 4)]),
        ([NAN, NAN], []),
        ([], [(0, 0)]),
    ],
)
def test_a_curve_is_in_parts_between_what_is_nothing(values: list[float], parts: list[tuple[int, int]]) -> None:
    assert [(part.start, part.stop) for part in _whole_parts(np.array(values, float))] == parts


def test_each_part_of_two_points_or_more_is_a_line_and_the_box_is_around_them(qtbot: QtBot) -> None:
    line = Line()
    x, y = np.arange(8.0), np.array([1.0, 3.0, NAN, 9.0, NAN, -2.0, 5.0, 4.0])
    line.set_points(x, y)
    pen = Pen()
    line.set_pen(QPen())
    line.paint(pen)
    drawn = [[(point.x(), point.y()) for point in points] for (points,) in pen.of("drawPolyline")]
    assert drawn == [[(0, 1), (1, 3)], [(5, -2), (6, 5), (7, 4)]]
    assert line.boundingRect() == QRectF(0, -2, 7, 7)


def test_a_level_line_still_has_a_box_and_other_points_another(qtbot: QtBot) -> None:
    line = Line()
    line.set_points(np.arange(4.0), np.full(4, 2.0))
    assert not line.boundingRect().isEmpty() and line.boundingRect().top() == 2
    line.set_points(np.arange(4.0), np.full(4, NAN))
    assert line.boundingRect() == QRectF()
