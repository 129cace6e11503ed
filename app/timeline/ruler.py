"""The ruler's ticks, in frames or in timecode, as many as have room for their labels."""

from __future__ import annotations

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QPainter

from app.theme import Palette
from app.timeline.hits import Layout
from engine.take import timecode

LABEL_PX = 84
STEPS_FRAMES = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000)
STEPS_S = (0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600)


def draw_ticks(painter: QPainter, layout: Layout, fps: float, colours: Palette, *, in_frames: bool) -> None:
    """Draw a tick with its label for each step of time; none is cut at the lanes' ends."""
    first, last = layout.range
    per_second = layout.width_px / max(1e-9, (last - first) / fps)
    steps_s = [frames / fps for frames in STEPS_FRAMES] if in_frames else STEPS_S
    step = next((s for s in steps_s if s * per_second >= LABEL_PX), steps_s[-1])
    index = int(first / fps / step)
    middle = Qt.AlignmentFlag.AlignCenter
    while index * step * fps <= last:
        time_s = index * step
        x = layout.x_of(time_s * fps)
        painter.setPen(QColor(colours.quiet))
        shown = f"{round(time_s * fps):,}" if in_frames else timecode(time_s, fps)
        half = painter.fontMetrics().horizontalAdvance(shown) / 2
        if layout.left_px <= x - half and x + half <= layout.left_px + layout.width_px:
            painter.drawText(QRectF(x - 50, 4, 100, 14), middle, shown)
        painter.setPen(QColor(colours.edge))
        painter.drawLine(int(x), 20, int(x), int(layout.ruler_px))
        index += 1
