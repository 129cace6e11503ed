"""What lies over or under all lanes alike: playhead, selection, lost spans, the reach of the brush."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QPainter, QPen
from PySide6.QtWidgets import QGraphicsItem, QStyleOptionGraphicsItem, QWidget

from app.theme import Palette

Marks = list[tuple[float, float]]  # half-open ranges of frames
NOTE_LANE = 4  # of the theme's colours
APART_PX, FEW = 2.0, 100  # lines nearer to each other are one, where there are more than a few
RING_PX = 4.0  # radius of the corners


class Overlay(QGraphicsItem):
    """Covers all lanes; draws nothing until it has a theme's colours.

    Parameters
    ----------
    area : gives the box of all lanes in the scene
    x_of : scene position of a frame
    depth : over the lanes where it is above zero, under them below
    """

    def __init__(self, area: Callable[[], QRectF], x_of: Callable[[float], float], depth: int) -> None:
        super().__init__()
        self._area, self._x_of = area, x_of
        self.colours: Palette | None = None
        self.setZValue(depth)

    def boundingRect(self) -> QRectF:
        """Cover all lanes."""
        return self._area()

    def moved(self) -> None:
        """Draw again at the lanes' current places."""
        self.prepareGeometryChange()
        self.update()

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        """Draw in the theme's colours."""
        if self.colours is not None:
            self._draw(painter, self._area(), self.colours)

    def _draw(self, painter: QPainter, area: QRectF, colours: Palette) -> None:
        raise NotImplementedError


class Underlay(Overlay):
    """Tints and hatches behind the curves."""

    def __init__(self, area: Callable[[], QRectF], x_of: Callable[[float], float]) -> None:
        super().__init__(area, x_of, -10)
        self.spans: Marks = []
        self.notes: Marks = []  # that are open
        self.selection: tuple[float, float] | None = None
        self.brush_reach: tuple[float, float] | None = None
        self.brush_box: Callable[[], QRectF] = QRectF

    def _draw(self, painter: QPainter, area: QRectF, colours: Palette) -> None:
        """Draw spans hatched and tinted, the selection and the brush tinted."""
        painter.setClipRect(area)
        painter.setPen(Qt.PenStyle.NoPen)
        hatch, tint = QColor(colours.warning), QColor(colours.warning)
        hatch.setAlphaF(0.22)
        tint.setAlphaF(0.05)
        for left, right in self._stretches(area):
            box = QRectF(left, area.top(), right - left, area.height())
            painter.fillRect(box, tint)
            painter.fillRect(box, QBrush(hatch, Qt.BrushStyle.BDiagPattern))
        self._draw_notes(painter, area, colours)
        chosen = QColor(colours.text)
        chosen.setAlphaF(0.07)
        if self.selection is not None:
            painter.fillRect(self._box(self.selection, area), chosen)
        if self.brush_reach is not None:
            reach = QColor(colours.accent)
            reach.setAlphaF(0.09)
            painter.fillRect(self._box(self.brush_reach, self.brush_box()), reach)

    def _draw_notes(self, painter: QPainter, area: QRectF, colours: Palette) -> None:
        """Draw a dotted line through all lanes where each note begins, and tint the frames of one that is on several."""
        colour, tint = QColor(colours.lanes[NOTE_LANE]), QColor(colours.lanes[NOTE_LANE])
        tint.setAlphaF(0.07)
        if not self.notes:
            return
        frames = np.array(self.notes)
        places = self._x_of(0.0) + frames * (self._x_of(1.0) - self._x_of(0.0))
        seen = (places[:, 1] >= area.left()) & (places[:, 0] <= area.right())
        for start, stop in frames[seen & (frames[:, 1] - frames[:, 0] > 1)].tolist():
            painter.fillRect(self._box((start, stop), area), tint)
        painter.setPen(QPen(colour, 1, Qt.PenStyle.DotLine))
        begins = places[seen & (places[:, 0] >= area.left()), 0]
        for left in np.unique(np.floor(begins / APART_PX)) * APART_PX + APART_PX / 2 if len(begins) > FEW else begins:
            painter.drawLine(QLineF(left, area.top(), left, area.bottom()))
        painter.setPen(Qt.PenStyle.NoPen)

    def _stretches(self, area: QRectF) -> Marks:
        """Return where spans lie on screen, left and right; those that share a pixel are one, or a take that lost its
        face at every other frame would be drawn in thousands of boxes for each picture."""
        if not self.spans:
            return []
        begin = self._x_of(-0.5)
        edges = begin + np.array(self.spans, float) * (self._x_of(0.5) - begin)
        edges[:, 1] = np.maximum(edges[:, 1], edges[:, 0] + 1.0)
        edges = edges[(edges[:, 1] >= area.left()) & (edges[:, 0] <= area.right())]
        edges = edges[np.argsort(edges[:, 0], kind="stable")].clip(area.left() - 1, area.right() + 1)
        if not len(edges):
            return []
        reach = np.maximum.accumulate(edges[:, 1])
        apart = np.flatnonzero(np.floor(edges[1:, 0]) > np.floor(reach[:-1])) + 1
        first, last = np.concatenate([[0], apart]), np.concatenate([apart - 1, [len(edges) - 1]])
        stretches: Marks = np.stack([edges[first, 0], reach[last]], axis=1).tolist()
        return stretches

    def _box(self, frames: tuple[float, float], area: QRectF) -> QRectF:
        left, right = self._x_of(frames[0] - 0.5), self._x_of(frames[1] - 0.5)
        return QRectF(left, area.top(), max(1.0, right - left), area.height())


class Playhead(Overlay):
    """A line through every lane at the frame that is shown, and the box and handles of the tool at work."""

    def __init__(self, area: Callable[[], QRectF], x_of: Callable[[float], float]) -> None:
        super().__init__(area, x_of, 10)
        self.frame = 0
        self.box, self.handles = QRectF(), list[QPointF]()

    def _draw(self, painter: QPainter, area: QRectF, colours: Palette) -> None:
        """Draw the line where the frame is on screen, then the box of a tool."""
        x = self._x_of(self.frame)
        if area.left() <= x <= area.right():
            painter.setPen(QPen(QColor(colours.text), 1))
            painter.drawLine(QLineF(x, area.top(), x, area.bottom()))
        if not self.box.isNull():
            painter.setPen(QPen(QColor(colours.accent), 1, Qt.PenStyle.DashLine))
            painter.drawRect(self.box)
            painter.setBrush(QColor(colours.accent))
            for handle in self.handles:
                painter.drawRect(QRectF(handle.x() - 4, handle.y() - 4, 8, 8))


class FocusRing(Overlay):
    """A line around the lane that is worked on, while keys go to it."""

    def __init__(self, area: Callable[[], QRectF], x_of: Callable[[float], float]) -> None:
        super().__init__(area, x_of, 20)

    def _draw(self, painter: QPainter, area: QRectF, colours: Palette) -> None:
        if not area.isNull():
            painter.setPen(QPen(QColor(colours.accent), 1))
            painter.drawRoundedRect(area.adjusted(1.5, 0.5, -0.5, -0.5), RING_PX, RING_PX)
