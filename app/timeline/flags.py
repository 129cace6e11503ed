"""Automatic findings as marks: what weighs more is larger, brighter and of another shape."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from app.theme import Palette
from engine.quality import Flag

FLAGS_PX = 18
SERIOUS, NOTABLE = 0.66, 0.4  # weights from which a flag is drawn as such
APART_PX = 9  # marks that would lie closer are one, of the heaviest


@dataclass(frozen=True)
class Mark:
    """A flag where it is drawn, and how many others are drawn with it."""

    x: float
    flag: Flag
    others: int

    @property
    def sentence(self) -> str:
        """The text to show for it."""
        more = f" {self.others} more here: zoom in." if self.others else ""
        return f"{self.flag.sentence}{more}"


class FlagLane:
    """Draws the flags of a view.

    Attributes
    ----------
    marks : what was drawn last
    """

    def __init__(self) -> None:
        self._flags: tuple[Flag, ...] | None = None
        self._starts, self._weights = np.zeros(0), np.zeros(0)
        self.marks: list[Mark] = []

    def draw(
        self,
        painter: QPainter,
        flags: tuple[Flag, ...] | None,
        box: QRectF,
        view: tuple[float, float],
        colours: Palette,
    ) -> None:
        """Draw the flags that begin in a view, first and last frame, in a box whose edges those are."""
        self._learn(flags)
        self.marks = self._laid_out(box, view)
        if not flags:
            painter.setPen(QColor(colours.faint))
            middle = Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft
            painter.drawText(box.adjusted(6, 0, 0, 0), middle, "looking…" if flags is None else "no flags")
        per_frame = box.width() / max(1e-9, view[1] - view[0])
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for mark in self.marks:
            _draw(painter, mark, box, per_frame, colours)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)

    def _learn(self, flags: tuple[Flag, ...] | None) -> None:
        if flags is not self._flags:
            self._flags = flags
            self._starts = np.array([flag.start for flag in flags or ()], float)
            self._weights = np.array([flag.weight for flag in flags or ()])

    def _laid_out(self, box: QRectF, view: tuple[float, float]) -> list[Mark]:
        """Return one mark for each stretch of the lane, the heaviest; stretches are fixed to frames, not to the view."""
        if not self._flags:
            return []
        per_frame = box.width() / max(1e-9, view[1] - view[0])
        first, last = np.searchsorted(self._starts, (view[0] - APART_PX / per_frame, view[1] + 1))
        if first >= last:
            return []
        cells = np.floor(self._starts[first:last] * per_frame / APART_PX).astype(np.int64)
        begins = np.flatnonzero(np.diff(cells, prepend=-1))
        marks = []
        for begin, end in zip(begins, np.append(begins[1:], len(cells)), strict=True):
            heaviest = first + begin + int(np.argmax(self._weights[first + begin : first + end]))
            x = box.left() + (self._starts[heaviest] - view[0]) * per_frame
            marks.append(Mark(float(x), self._flags[heaviest], int(end - begin - 1)))
        return marks


def _draw(painter: QPainter, mark: Mark, box: QRectF, per_frame: float, colours: Palette) -> None:
    """Draw a serious flag as a triangle, a notable one as a diamond, a slight one as a dot; a line shows how long it is."""
    x, y, weight = mark.x, box.center().y(), mark.flag.weight
    shade = QColor(colours.lanes[5] if weight >= SERIOUS else colours.warning if weight >= NOTABLE else colours.quiet)
    length = (mark.flag.stop - mark.flag.start - 1) * per_frame
    if length > APART_PX:
        painter.setPen(QPen(shade, 2))
        painter.drawLine(QPointF(x, box.bottom() - 2), QPointF(min(x + length, box.right()), box.bottom() - 2))
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(shade)
    if weight >= SERIOUS:
        painter.drawPolygon([QPointF(x - 5, y + 4), QPointF(x, y - 5.5), QPointF(x + 5, y + 4)])
    elif weight >= NOTABLE:
        painter.drawPolygon([QPointF(x - 4, y), QPointF(x, y - 4), QPointF(x + 4, y), QPointF(x, y + 4)])
    else:
        painter.drawEllipse(QPointF(x, y), 2.5, 2.5)
