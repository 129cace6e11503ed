"""Pins and notes on the timeline: however many there are, no more are drawn than there is room for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from app.theme import Palette
from engine.project import Marks, Note, Pin
from engine.words import NAME_LENGTH, plain

LANE_PX = 18
APART_PX = 4  # a mark that is nearer to the one before is not drawn
NOTE_LANE = 4  # of the theme's colours
NOTE_PX = 220  # what a note's text may take


def lanes(marks: Marks) -> list[str]:
    """Return the names of the lanes that have something to show."""
    return [name for name, shown in (("pins", marks.pins), ("notes", marks.notes)) if shown]


def draw_marks(
    painter: QPainter, marks: Marks, name: str, place: tuple[QRectF, tuple[float, float]], colours: Palette
) -> None:
    """Draw one of `lanes` in its place: a box, and the view whose first and last frame are the box's edges.

    A pin is a diamond with its range, a note a dot with its range and its text, hollow once it is resolved.
    """
    box, view = place
    per_frame = box.width() / max(1e-9, view[1] - view[0])
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    if name == "pins":
        _draw_pins(painter, marks.pins, box, (view[0], per_frame), colours)
    else:
        _draw_notes(painter, marks.notes, box, (view[0], per_frame), colours)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)


def draw_ranges(
    painter: QPainter, ranges: Sequence[tuple[int, int]], place: tuple[QRectF, tuple[float, float]], colours: Palette
) -> None:
    """Draw half-open ranges of frames as blocks, none thinner than can be seen."""
    box, view = place
    per_frame = box.width() / max(1e-9, view[1] - view[0])
    block = box.adjusted(0, 4, 0, -4)
    for start, stop in ranges:
        left, right = (box.left() + (frame - 0.5 - view[0]) * per_frame for frame in (start, stop))
        if right >= box.left() and left <= box.right():
            painter.fillRect(
                QRectF(left, block.top(), max(2.0, right - left), block.height()), QColor(colours.lanes[5])
            )


def _draw_pins(
    painter: QPainter, pins: Sequence[Pin], box: QRectF, scale: tuple[float, float], colours: Palette
) -> None:
    y, left, (first, per_frame) = box.center().y(), box.left(), scale
    painter.setPen(QColor(colours.accent))
    painter.setBrush(QColor(colours.accent))
    ends = left + (np.array([(pin.start, pin.stop - 1) for pin in pins], float) - first) * per_frame
    for start, stop in ends[_in_sight(ends[:, 0], ends[:, 1], box)].tolist():
        painter.drawLine(QPointF(start, y), QPointF(stop, y))
    places = left + (np.array([pin.frame for pin in pins], float) - first) * per_frame
    for _, x in _apart(places, box):
        painter.drawPolygon([QPointF(x - 5, y), QPointF(x, y - 5), QPointF(x + 5, y), QPointF(x, y + 5)])


def _draw_notes(
    painter: QPainter, notes: Sequence[Note], box: QRectF, scale: tuple[float, float], colours: Palette
) -> None:
    y, (first, per_frame) = box.center().y(), scale
    places = box.left() + (np.array([note.frame for note in notes], float) - first) * per_frame
    shown = list(_apart(places, box))
    colour = QColor(colours.lanes[NOTE_LANE])
    ends = places + (np.array([note.frames - 1 for note in notes], float)) * per_frame
    long = [index for index in _in_sight(places, ends, box).tolist() if ends[index] > places[index]]
    painter.setPen(QPen(colour, 1.5))
    for index in long:
        foot = box.bottom() - 2.5
        painter.drawLine(QPointF(places[index], foot), QPointF(ends[index], foot))
        painter.drawLine(QPointF(ends[index], foot), QPointF(ends[index], foot - 5))
    for index, x in shown:
        painter.setBrush(QColor(colours.panel) if notes[index].resolved else colour)
        painter.drawEllipse(QPointF(x, y), 4.0, 4.0)
    nexts = [*(x for _, x in shown[1:]), np.inf]  # of none in sight there is no text either
    for (index, x), following in zip(shown, nexts, strict=False):
        painter.setPen(QColor(colours.quiet if notes[index].resolved else colours.text))
        room = min(NOTE_PX, following - x - 14)
        if room > 24:
            text = painter.fontMetrics().elidedText(
                plain(notes[index].text, longest=NAME_LENGTH), Qt.TextElideMode.ElideRight, int(room)
            )
            painter.drawText(QRectF(x + 8, box.top(), room, box.height()), Qt.AlignmentFlag.AlignVCenter, text)


def _in_sight(starts: np.ndarray, stops: np.ndarray, box: QRectF) -> np.ndarray:
    """Return which stretches to draw, given in pixels: those in the box that reach beyond the ones before."""
    beyond = stops > np.maximum.accumulate(np.concatenate([[-np.inf], stops[:-1]])) + 1
    return np.flatnonzero((stops >= box.left()) & (starts <= box.right()) & beyond)


def _apart(places: np.ndarray, box: QRectF) -> Iterator[tuple[int, float]]:
    """Yield index and place, in pixels, of the marks that do not overlap the one before; a text may reach in from the left."""
    last = -np.inf
    for index in np.flatnonzero((places >= box.left() - NOTE_PX) & (places <= box.right() + 5)).tolist():
        x = float(places[index])
        if x - last >= APART_PX:
            last = x
            yield index, x
