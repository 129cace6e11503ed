"""Before and after in one picture, parted by a line that is dragged across the face."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QColor, QImage, QPainter, QPen

from app.theme import GRID

LINE, DARK = QColor("#e3e6eb"), QColor("#14161a")
NEAR_PX = 8  # how far beside the line it may be taken hold of
KNOB_PX = 7.0
STEP = 0.05  # of the picture's width, by a key
LOWEST, HIGHEST = 0.02, 0.98  # so that the line can always be taken hold of


class Wipe:
    """Where the line is, and whether it is held.

    Attributes
    ----------
    share : of the picture's width that shows the face before
    """

    def __init__(self) -> None:
        self.share = 0.5
        self.held = False

    def is_at(self, x: float, width: float) -> bool:
        """Return whether a press at a place grabs the line."""
        return abs(x - self.share * width) <= NEAR_PX

    def move_to(self, x: float, width: float) -> None:
        """Bring the line to a place."""
        self.share = float(np.clip(x / max(1.0, width), LOWEST, HIGHEST))

    def step(self, by: int) -> None:
        """Move the line a step to the left or right."""
        self.share = float(np.clip(self.share + STEP * by, LOWEST, HIGHEST))

    def draw(self, painter: QPainter, image: QImage, box: QRectF) -> None:
        """Draw the left half of an image up to the line and the right half, which is as wide, from there on."""
        half = image.width() / 2
        at = self.share * box.width()
        left = QRectF(box.left(), box.top(), at, box.height())
        right = QRectF(box.left() + at, box.top(), box.width() - at, box.height())
        painter.drawImage(left, image, QRectF(0, 0, half * self.share, image.height()))
        painter.drawImage(right, image, QRectF(half * (1 + self.share), 0, half * (1 - self.share), image.height()))

    def draw_line(self, painter: QPainter, box: QRectF) -> None:
        """Draw the line with its knob, and what is on either side of it."""
        x = box.left() + self.share * box.width()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(LINE, 2))
        painter.drawLine(QPointF(x, box.top()), QPointF(x, box.bottom()))
        painter.setPen(QPen(DARK, 1))
        painter.setBrush(LINE)
        painter.drawEllipse(QPointF(x, box.bottom() - 5 * GRID), KNOB_PX, KNOB_PX)
        painter.setPen(LINE)
        metrics = painter.fontMetrics()
        before, after = metrics.horizontalAdvance("before"), metrics.horizontalAdvance("after")
        if x - box.left() > before + 2 * GRID:
            painter.drawText(QPointF(box.left() + GRID, box.top() + 18), "before")
        if box.right() - x > after + 2 * GRID:
            painter.drawText(QPointF(box.right() - after - GRID, box.top() + 18), "after")
