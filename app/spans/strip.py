"""Variants of a fill as small moving pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QRect, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QImage, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from engine.take import Array

if TYPE_CHECKING:
    from engine.editing import Patch

COLUMNS, CELL_W, CELL_H = 3, 70, 88
TICK_MS = 90


class Strip(QWidget):
    """Up to six small faces that play their variant over and over; a click chooses one."""

    chosen = Signal(int)
    wanted = Signal(object)  # weights, (52,) each, to draw side by side

    def __init__(self) -> None:
        super().__init__()
        self._variants: list[Patch] = []
        self._chosen, self._frame, self._first = 0, 0, 1
        self._image = QImage()
        self._timer = QTimer(self, interval=TICK_MS)
        self._timer.timeout.connect(self._tick)
        self.setAccessibleName("Fill variants")
        self.setToolTip("Click a variant, or compare them with the arrow keys; Enter keeps the one that is framed.")

    def sizeHint(self) -> QSize:
        """Two rows of three."""
        return QSize(COLUMNS * CELL_W, CELL_H * (-(-max(1, len(self._variants)) // COLUMNS)))

    def minimumSizeHint(self) -> QSize:
        """No smaller than needed."""
        return self.sizeHint()

    def show_variants(self, variants: list[Patch], chosen: int, *, first: int = 1) -> None:
        """Play these, counted from `first`, with one framed; none stops."""
        self._first = first
        if variants is not self._variants:
            self._variants, self._frame, self._image = variants, 0, QImage()
            self.updateGeometry()
        self._chosen = chosen
        if variants:
            self._timer.start()
        else:
            self._timer.stop()
        self.update()

    def show_picture(self, picture: np.ndarray) -> None:
        """Show the faces side by side, (height, width, 3) uint8, as they were wanted."""
        height, width = picture.shape[:2]
        self._image = QImage(picture.data, width, height, 3 * width, QImage.Format.Format_RGB888).copy()
        self.update()

    def _tick(self) -> None:
        if not self._variants or not self.isVisible():
            return
        self._frame = (self._frame + 3) % len(self._variants[0].weights)
        faces: list[Array] = [variant.weights[self._frame] for variant in self._variants]
        self.wanted.emit(faces)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the faces and a frame round the chosen one."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        for index in range(len(self._variants)):
            cell = self._cell(index)
            if not self._image.isNull():
                width = self._image.width() // len(self._variants)
                painter.drawImage(cell, self._image, QRect(index * width, 0, width, self._image.height()))
            painter.setPen(QPen(QColor("#56B4E9" if index == self._chosen else "#2a2f38"), 2))
            painter.drawRect(cell.adjusted(1, 1, -1, -1))
            number = str(self._first + index)
            width = painter.fontMetrics().horizontalAdvance(number) + 6
            painter.fillRect(QRect(cell.left() + 3, cell.top() + 3, width, 16), QColor(20, 22, 26, 170))
            painter.setPen(QColor("#e3e6eb"))
            painter.drawText(cell.adjusted(6, 4, 0, 0), Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop, number)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Choose the variant under the pointer."""
        for index in range(len(self._variants)):
            if self._cell(index).contains(event.position().toPoint()):
                self.chosen.emit(index)

    def _cell(self, index: int) -> QRect:
        row, column = divmod(index, COLUMNS)
        return QRect(column * CELL_W, row * CELL_H, CELL_W - 2, CELL_H - 2)
