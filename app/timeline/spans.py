"""Spans as hatched boxes: however many there are, no more are drawn than there is room for."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QPainter, QPen

from app.theme import Palette
from engine.project import Span
from engine.words import NAME_LENGTH, plain

GAP_PX = 2.0  # a span that ends this near to the one before is not drawn
NAME_PX = 24  # boxes below this have no name


class SpanLane:
    """Draws the spans of a view."""

    def __init__(self) -> None:
        self._spans: tuple[Span, ...] = ()
        self._frames = np.zeros((0, 2))  # where each begins and ends

    def draw(
        self, painter: QPainter, spans: tuple[Span, ...], box: QRectF, view: tuple[float, float], colours: Palette
    ) -> None:
        """Draw the spans to work on that reach into a view, first and last frame, in a box whose edges those are."""
        if spans is not self._spans:
            self._spans = spans
            self._frames = np.array([(span.start, span.stop) for span in spans], float).reshape(-1, 2) - 0.5
        per_frame = box.width() / max(1e-9, view[1] - view[0])
        ends = box.left() + (self._frames - view[0]) * per_frame
        warning = QColor(colours.warning)
        tint = QColor(warning)
        tint.setAlphaF(0.12)
        painter.setPen(QPen(warning, 1))
        drawn_to = -np.inf
        for index in np.flatnonzero((ends[:, 1] >= box.left()) & (ends[:, 0] <= box.right())).tolist():
            left, right = ends[index].tolist()
            if right < drawn_to + GAP_PX:
                continue
            drawn_to = right
            shown = QRectF(left, box.top() + 3, max(3.0, right - left), box.height() - 7)
            painter.setBrush(tint)
            painter.drawRect(shown)
            painter.setBrush(QBrush(warning, Qt.BrushStyle.BDiagPattern))
            painter.drawRect(shown)
            if shown.width() > NAME_PX:
                _draw_name(painter, spans[index], shown, colours)


def _draw_name(painter: QPainter, span: Span, box: QRectF, colours: Palette) -> None:
    title = "lost" if span.kind == "lost" else plain(span.region, longest=NAME_LENGTH)
    text = painter.fontMetrics().horizontalAdvance(title) + 10
    if box.width() > text + 4:
        label = QRectF(box.center().x() - text / 2, box.top() + 1, text, box.height() - 2)
        painter.fillRect(label, QColor(colours.panel))
        painter.drawText(label, Qt.AlignmentFlag.AlignCenter, title)
