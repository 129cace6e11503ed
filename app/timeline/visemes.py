"""What is said, as labelled blocks: coloured by what the mouth does, true to time at every zoom."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QIcon, QImage, QPainter, QPen, QPixmap

from app.theme import Palette
from engine.speech.lane import GROUP_OF, GROUPS, VisemeLane
from engine.speech.visemes import CLASSES, NAMES, class_of
from engine.take import Array
from engine.words import NAME_LENGTH, plain

VISEMES_PX = 26
EDGE_PX = 4  # how near a boundary the pointer takes hold of it
BLOCK_PX = 5  # blocks that are narrower on average are drawn without their boundaries and names
BAR_PX, ROOM_PX, NAME_PX = 3, 4, 11  # a block's strong edge, what its name needs beside itself, and the name's size
Place = tuple[QRectF, tuple[float, float]]  # a lane's box, and the times of the take at its left and right edge
FILL, SILENT = 0.34, 0.3  # how opaque a block is, and its colour where nothing is said


def group_colours(colours: Palette) -> list[str]:
    """Return #rrggbb for each of `GROUPS`."""
    blue, orange, green, yellow, pink, vermilion, violet, _ = colours.lanes
    return [colours.faint, vermilion, pink, violet, yellow, orange, green, blue]


def group_of(label: str) -> int:
    """Return which of `GROUPS` a label belongs to."""
    return int(GROUP_OF[class_of(label)])


def describe(lane: VisemeLane, index: int) -> str:
    """Return the tool tip of a cue."""
    cue, (start_s, stop_s) = lane.cues[index], lane.times_s[index]
    label = plain(cue.label, longest=NAME_LENGTH) or "silence"
    group = list(GROUPS)[group_of(cue.label)]
    return f"{label}: {group}, {start_s:.2f} to {stop_s:.2f} s. Drag its ends, double-click to select, right-click to change."


def icon(name: str, colours: Palette) -> QIcon:
    """Return a swatch in the colour of a viseme class."""
    picture = QPixmap(12, 12)
    picture.fill(QColor(group_colours(colours)[group_of(name)]))
    return QIcon(picture)


def choices() -> list[tuple[str, str]]:
    """Return each class and its title in a menu, with its phones."""
    return [(name, f"{name}   {' '.join(CLASSES[name][:4])}") for name in NAMES]


class VisemeStrip:
    """Draws a lane; what any stretch of it holds is known without going through its cues."""

    def __init__(self) -> None:
        self._lane: VisemeLane | None = None
        self._times_s = np.zeros(0)
        self._sums_s = np.zeros((0, 0))  # (groups, 2 cues) how long each group was said up to each begin and end

    def draw(self, painter: QPainter, lane: VisemeLane, place: Place, colours: Palette) -> None:
        """Draw the stretch of a lane that the edges of its place bound."""
        box, between_s = place
        self._learn(lane)
        columns = max(1, round(box.width() * painter.device().devicePixelRatio()))
        picture = self._picture(np.linspace(*between_s, columns + 1), colours)
        bar = QRectF(box.left(), box.bottom() - BAR_PX, box.width(), BAR_PX)
        painter.setOpacity(FILL)
        painter.drawImage(box.adjusted(0, 0, 0, -BAR_PX), picture)
        painter.setOpacity(1.0)
        painter.drawImage(bar, picture)
        first = int(np.searchsorted(lane.times_s[:, 1], between_s[0], side="right"))
        last = int(np.searchsorted(lane.times_s[:, 0], between_s[1]))
        if (last - first) * BLOCK_PX <= box.width():
            _write_small(painter)
            for index in range(first, last):
                ends = _across(box, between_s, lane.times_s[index])
                _draw_name(painter, lane.cues[index].label, box, ends, colours)

    def draw_moved(
        self, painter: QPainter, lane: VisemeLane, indices: list[int], place: Place, colours: Palette
    ) -> None:
        """Draw some cues as they would be, over what is drawn already."""
        box, between_s = place
        _write_small(painter)
        ends = [_across(box, between_s, np.array(_taken(lane, index))) for index in indices]
        around = _across(box, between_s, np.array(_around(lane, indices)))
        painter.fillRect(QRectF(around[0], box.top(), around[1] - around[0], box.height()), QColor(colours.panel))
        for index, (left, right) in zip(indices, ends, strict=True):
            shade = QColor(group_colours(colours)[group_of(lane.cues[index].label)])
            painter.setOpacity(FILL)
            painter.fillRect(QRectF(left, box.top(), right - left, box.height() - BAR_PX), shade)
            painter.setOpacity(1.0)
            painter.fillRect(QRectF(left, box.bottom() - BAR_PX, right - left, BAR_PX), shade)
            _draw_name(painter, lane.cues[index].label, box, (left, right), colours)

    def _learn(self, lane: VisemeLane) -> None:
        if lane is self._lane:
            return
        self._lane, self._times_s = lane, lane.times_s.reshape(-1)
        lasting = np.diff(lane.times_s, axis=1)[:, 0]
        groups = GROUP_OF[lane.classes]
        sums_s = np.zeros((len(GROUPS), 2 * len(lasting)))
        for group in range(len(GROUPS)):
            total = np.cumsum(np.where(groups == group, lasting, 0.0))
            sums_s[group, 1::2] = total
            sums_s[group, 2::2] = total[:-1]
        self._sums_s = sums_s

    def _picture(self, edges_s: Array, colours: Palette) -> QImage:
        """Return an image one pixel high, a column for each pair of edges: the mixture of what is said in between."""
        spoken_s = np.array([np.diff(np.interp(edges_s, self._times_s, total)) for total in self._sums_s])
        share = np.clip(spoken_s / np.maximum(np.diff(edges_s), 1e-12), 0.0, 1.0)
        share[0] *= SILENT
        named = [QColor(name) for name in group_colours(colours)]
        shades = np.array([(shade.red(), shade.green(), shade.blue()) for shade in named], np.float64)
        mixed = np.clip(share.T @ shades, 0, 255).astype(np.uint32)
        alpha = np.clip(255 * share.sum(axis=0), 0, 255).astype(np.uint32)
        pixels = alpha << 24 | mixed[:, 0] << 16 | mixed[:, 1] << 8 | mixed[:, 2]
        count = len(pixels)
        return QImage(pixels.tobytes(), count, 1, 4 * count, QImage.Format.Format_ARGB32_Premultiplied).copy()


def _across(box: QRectF, between_s: tuple[float, float], times_s: Array) -> tuple[float, float]:
    per_s = box.width() / max(1e-9, between_s[1] - between_s[0])
    left, right = (box.left() + (float(time_s) - between_s[0]) * per_s for time_s in times_s)
    return left, right


def _taken(lane: VisemeLane, index: int) -> tuple[float, float]:
    cue = lane.cues[index]
    return cue.start_s + lane.offset_s, cue.stop_s + lane.offset_s


def _around(lane: VisemeLane, indices: list[int]) -> tuple[float, float]:
    """Return from the end of the cue before to the beginning of the one after."""
    before, after = indices[0] - 1, indices[-1] + 1
    start = _taken(lane, before)[1] if before >= 0 else _taken(lane, indices[0])[0] - 1e3
    stop = _taken(lane, after)[0] if after < len(lane.cues) else _taken(lane, indices[-1])[1] + 1e3
    return start, stop


def _write_small(painter: QPainter) -> None:
    font = QFont(painter.font())
    font.setPixelSize(NAME_PX)
    painter.setFont(font)


def _draw_name(painter: QPainter, label: str, box: QRectF, ends: tuple[float, float], colours: Palette) -> None:
    """Draw a block's boundaries, and its name where it fits."""
    left, right = ends
    painter.setPen(QPen(QColor(colours.panel), 1))
    painter.drawLine(QPointF(left, box.top()), QPointF(left, box.bottom()))
    painter.drawLine(QPointF(right, box.top()), QPointF(right, box.bottom()))
    left, right = max(left, box.left()), min(right, box.right())  # the name stays in sight for as long as its block is
    name = plain(label, longest=NAME_LENGTH)
    for text in (name, name.rstrip("012")):  # stress is the first thing to do without
        if painter.fontMetrics().horizontalAdvance(text) + ROOM_PX <= right - left:
            painter.setPen(QColor(colours.text))
            inside = QRectF(left, box.top(), right - left, box.height() - BAR_PX)
            painter.drawText(inside, Qt.AlignmentFlag.AlignCenter, text)
            return
