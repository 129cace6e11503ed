"""A curve drawn as plain lines: nothing is built that a pan would throw away."""

from __future__ import annotations

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QRectF
from PySide6.QtGui import QPainter, QPen, QPolygonF

from engine.take import Array


class Line(pg.GraphicsObject):  # type: ignore[misc]
    """Lines from point to point, with gaps where a value is NaN."""

    def __init__(self) -> None:
        super().__init__()
        self._pen = QPen()
        self._parts: list[QPolygonF] = []
        self._box = QRectF()

    def set_pen(self, pen: QPen) -> None:
        """Draw with a cosmetic pen."""
        self._pen = pen
        self.update()

    def set_points(self, x: Array, y: Array) -> None:
        """Draw lines through points, (n,) each."""
        self.prepareGeometryChange()
        parts = [part for part in _whole_parts(y) if part.stop - part.start > 1]
        self._parts = [pg.functions.arrayToQPolygonF(x[part], y[part]) for part in parts]
        self._box = QRectF()
        for part in parts:
            low, high = float(y[part].min()), float(y[part].max())
            self._box |= QRectF(x[part][0], low, x[part][-1] - x[part][0], (high - low) or 1e-9)
        self.update()

    def boundingRect(self) -> QRectF:
        """Return the box around all points."""
        return self._box

    def paint(self, painter: QPainter, *_: object) -> None:
        """Draw the lines."""
        painter.setPen(self._pen)
        for part in self._parts:
            painter.drawPolyline(part)


def _whole_parts(values: Array) -> list[slice]:
    """Return the runs of values that are not NaN."""
    gaps = np.isnan(values)
    if not gaps.any():
        return [slice(0, len(values))]
    edges = np.flatnonzero(np.diff(np.concatenate([[True], gaps, [True]])))
    return [slice(begin, end) for begin, end in edges.reshape(-1, 2).tolist()]
