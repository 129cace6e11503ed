"""What is drawn over the picture of heads side by side: their names, and dots with numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from app.preview.camera import Camera
from app.preview.picking import View, facing, places, views
from app.preview.renderer import HEAT, HEAT_FULL_MM
from app.session.sides import Dot, Side
from app.theme import GRID
from engine.take import Array, Mask
from engine.words import NAME_LENGTH, plain

DOT_PX, CHOSEN_PX, REACH_PX = 2.5, 5.0, 9.0
NUMBER_PX, NAME_PX = 9, 12
TEXT, DOT, CHOSEN, DARK = QColor("#e3e6eb"), QColor("#56B4E9"), QColor("#F0E442"), QColor("#14161a")


@dataclass(frozen=True, eq=False)
class Overlay:
    """Sides as one picture shows them.

    Attributes
    ----------
    sides, views : what is shown, and from where
    at : of each side, (n, 2) pixels of its dots
    seen : of each side, (n,) whether a dot is in front
    """

    sides: tuple[Side, ...]
    views: tuple[View, ...]
    at: tuple[Array, ...]
    seen: tuple[Mask, ...]

    @classmethod
    def of(cls, sides: tuple[Side, ...], camera: Camera, width: float, height: float) -> Overlay:
        """Return the overlay of sides on a widget of this size."""
        seen_from = views(sides, camera, width, height)
        at = [places(side) for side in sides]
        seen = [facing(side, view, points) for side, view, points in zip(sides, seen_from, at, strict=True)]
        flat = [view.project(points) for view, points in zip(seen_from, at, strict=True)]
        return cls(sides, tuple(seen_from), tuple(flat), tuple(seen))

    def side_at(self, x: float) -> int:
        """Return which side a pixel is on."""
        return int(np.clip(x // self.views[0].width, 0, len(self.sides) - 1))

    def dot_at(self, x: float, y: float) -> tuple[int, int] | None:
        """Return the side and the index of the dot under a pixel."""
        side = self.side_at(x)
        away = np.where(self.seen[side], np.linalg.norm(self.at[side] - (x, y), axis=1), np.inf)
        return (side, int(np.argmin(away))) if len(away) and away.min() <= REACH_PX else None

    def draw(self, painter: QPainter) -> None:
        """Draw names, borders and dots."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for index, (side, view) in enumerate(zip(self.sides, self.views, strict=True)):
            if index:
                painter.setPen(QPen(QColor("#3a404b"), 1))
                painter.drawLine(QPointF(view.left, 0), QPointF(view.left, view.height))
            self._draw_dots(painter, index)
            painter.setPen(TEXT)
            box = QRectF(view.left + GRID, 6, view.width - 2 * GRID, 18)
            name = painter.fontMetrics().elidedText(plain(side.label), Qt.TextElideMode.ElideMiddle, int(box.width()))
            if side.hint:
                middle = QRectF(view.left + 3 * GRID, 0, view.width - 6 * GRID, view.height)
                painter.drawText(middle, Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap, side.hint)
            painter.drawText(box, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, name)

    def _draw_dots(self, painter: QPainter, index: int) -> None:
        view = self.views[index]
        painter.save()
        painter.setClipRect(QRectF(view.left, 0, view.width, view.height))
        rows = zip(self.sides[index].dots, self.at[index], self.seen[index], strict=True)
        for dot, (x, y), seen in sorted(rows, key=lambda row: row[0].chosen):
            if not seen:
                continue
            size = CHOSEN_PX if dot.chosen else DOT_PX
            painter.setPen(QPen(DARK, 1))
            painter.setBrush(CHOSEN if dot.chosen else DOT)
            painter.drawEllipse(QPointF(x, y), size, size)
            if dot.number or dot.chosen:
                self._name(painter, view, dot, QPointF(x, y))
        painter.restore()

    def _name(self, painter: QPainter, view: View, dot: Dot, at: QPointF) -> None:
        """Write a dot's number, the chosen one's name as well, on the side of it where there is room."""
        font = painter.font()
        font.setPixelSize(NAME_PX if dot.chosen else NUMBER_PX)
        painter.setFont(font)
        text = plain(f"{dot.number} {dot.name}", longest=NAME_LENGTH) if dot.chosen else dot.number
        width, away = painter.fontMetrics().horizontalAdvance(text), (CHOSEN_PX if dot.chosen else DOT_PX) + 2
        left = at.x() + away + width > view.left + view.width
        _write(painter, at + QPointF(-away - width if left else away, -away + 1), text)


def draw_scale(painter: QPainter, height: int) -> None:
    """Draw what the colours of a difference are, at the foot of a picture of this height."""
    left, top, wide, high, steps = GRID, height - 34, 160, 8, 40
    for index in range(steps):
        at = index / (steps - 1) * (len(HEAT) - 1)
        colour = [int(np.interp(at, np.arange(len(HEAT)), channel)) for channel in HEAT.T]
        painter.fillRect(QRectF(left + index * wide / steps, top, wide / steps + 1, high), QColor(*colour))
    painter.drawText(left, top + 22, "0")
    painter.drawText(left + wide - 44, top + 22, f"{HEAT_FULL_MM:.0f} mm +")


def _write(painter: QPainter, at: QPointF, text: str) -> None:
    """Write light on a dark rim: it reads on skin as well as on the ground."""
    painter.setPen(DARK)
    for dx, dy in ((-1, 0), (1, 0), (0, -1), (0, 1)):
        painter.drawText(at + QPointF(dx, dy), text)
    painter.setPen(TEXT)
    painter.drawText(at, text)
