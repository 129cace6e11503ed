"""Pins and notes on the timeline."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter

from app.theme import Palette
from engine.project import Marks

LANE_PX = 18


def lanes(marks: Marks) -> list[str]:
    """Return the names of the lanes that have something to show."""
    return [name for name, shown in (("pins", marks.pins), ("notes", marks.notes)) if shown]


def draw_marks(painter: QPainter, marks: Marks, top: float, x_of: Callable[[float], float], colours: Palette) -> None:
    """Draw each lane below `top`: a diamond for a pin with its range, a dot with its text for a note."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    for row, name in enumerate(lanes(marks)):
        middle = top + (row + 0.5) * LANE_PX
        if name == "pins":
            _draw_pins(painter, marks, middle, x_of, colours)
        else:
            _draw_notes(painter, marks, middle, x_of, colours)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)


def _draw_pins(painter: QPainter, marks: Marks, y: float, x_of: Callable[[float], float], colours: Palette) -> None:
    for pin in marks.pins:
        x = x_of(pin.frame)
        painter.setPen(QColor(colours.accent))
        painter.drawLine(QPointF(x_of(pin.start), y), QPointF(x_of(pin.stop - 1), y))
        painter.setBrush(QColor(colours.accent))
        painter.drawPolygon([QPointF(x - 5, y), QPointF(x, y - 5), QPointF(x + 5, y), QPointF(x, y + 5)])


def _draw_notes(painter: QPainter, marks: Marks, y: float, x_of: Callable[[float], float], colours: Palette) -> None:
    places = [x_of(note.frame) for note in marks.notes]
    for note, x, following in zip(marks.notes, places, [*places[1:], 1e9], strict=True):
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(colours.good))
        painter.drawEllipse(QPointF(x, y), 4.0, 4.0)
        room = min(220.0, following - x - 14)
        if room > 24:
            painter.setPen(QColor(colours.text))
            shown = painter.fontMetrics().elidedText(note.text, Qt.TextElideMode.ElideRight, int(room))
            painter.drawText(QRectF(x + 8, y - LANE_PX / 2, room, LANE_PX), Qt.AlignmentFlag.AlignVCenter, shown)
