"""One lane: a control's curves in a view of its own, and its name in the gutter where no curve can cross it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QFont, QPainter

from app.curves import removed
from app.curves.line import Line
from app.curves.peaks import Rows, Thinned
from app.curves.places import GUTTER_PX
from app.curves.removed import Removed, full_scale
from app.session.curve_table import CURVES, FIRST_WEIGHT
from app.theme import GRID, Palette
from engine.take import Array, Mask, Take

INDENT_PX = 11
REMOVED, CROWDED_PX = "removed ", 48
LEAST_WEIGHT, LEAST_MM = 0.01, 0.1  # the smallest scale of what is removed


class Gutter(pg.GraphicsWidget):  # type: ignore[misc]
    """The name of a lane, its range and its value at the playhead."""

    def __init__(self, key: int) -> None:
        super().__init__()
        self._key, self._curve = key, CURVES[key]
        self.expanded = False
        self.colour, self.quiet, self.text_colour = QColor("white"), QColor("grey"), QColor("white")
        self.active, self.value, self.range = False, 0.0, (0.0, 1.0)
        self.spare = 0.0  # the part of the lane's height below its range, for what is removed
        self.removed = self.removed_short = ""  # where there is room for it, and where there is not
        self.removed_colour = QColor("white")

    def paint(self, painter: QPainter, *_: object) -> None:
        """Draw name and numbers."""
        area = QRectF(self.rect()).adjusted(GRID, 2, -GRID, -2)
        middle = area.center().y()
        font = QFont(painter.font())
        font.setPixelSize(11 if self._curve.is_weight else 12)
        font.setBold(self.active)
        painter.setFont(font)
        painter.setPen(self.colour)
        name_box = QRectF(area.left(), middle - 17, area.width() - (0 if self._curve.is_weight else 38), 17)
        left = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
        mark = "" if self._curve.is_weight else "▾ " if self.expanded else "▸ "
        indent = INDENT_PX if self._curve.is_weight else 0
        name_box.adjust(indent, 0, 0, 0)
        wide = painter.fontMetrics().horizontalAdvance(mark + self._curve.title)
        if self.active and wide > name_box.width():
            font.setBold(False)  # the frame and the larger lane tell which it is
            painter.setFont(font)
            wide = painter.fontMetrics().horizontalAdvance(mark + self._curve.title)
        if wide > name_box.width():
            font.setStretch(int(100 * name_box.width() / wide))  # a name that is cut may be another's
            painter.setFont(font)
        painter.drawText(name_box, left, mark + self._curve.title)
        font.setStretch(QFont.Stretch.Unstretched)
        font.setBold(False)
        painter.setFont(font)
        painter.setPen(self.text_colour)
        value_box = QRectF(area.left(), middle, area.width() - 34, 17)
        painter.drawText(value_box.adjusted(INDENT_PX, 0, 0, 0), left, self._curve.shown(self.value))
        font.setPixelSize(10)
        painter.setFont(font)
        painter.setPen(self.quiet)
        low, high = self.range
        right = Qt.AlignmentFlag.AlignRight
        if self.removed:
            painter.setPen(self.removed_colour)
            crowded = area.height() < CROWDED_PX and not self._curve.is_weight  # the value stands beside it
            text = self.removed_short if crowded else self.removed
            painter.drawText(area, right | Qt.AlignmentFlag.AlignBottom, text)
            painter.setPen(self.quiet)
            area.setHeight(area.height() * (1 - self.spare))
        if area.height() > 26 and not self._curve.is_weight:
            top, bottom, unit = f"{high:.0f}", f"{low:.0f}", f" {self._curve.unit}"
            if top == bottom:
                painter.drawText(area, right | Qt.AlignmentFlag.AlignVCenter, top + unit)
                return
            painter.drawText(area, right | Qt.AlignmentFlag.AlignTop, top + unit)
            painter.drawText(area, right | Qt.AlignmentFlag.AlignBottom, bottom)


class Lane:
    """A curve as opened (faint), as asked (dashed), as the face does it (solid).

    Parameters
    ----------
    key : which curve, an index into CURVES
    """

    def __init__(self, key: int) -> None:
        self.key, self.curve = key, CURVES[key]
        self.gutter = Gutter(key)
        self.view = pg.ViewBox(enableMouse=False, enableMenu=False, defaultPadding=0.0)
        self.view.setZValue(0)  # pyqtgraph puts it beneath everything
        self.original, self.asked, self.reached = (Line() for _ in range(3))
        self.dot = pg.ScatterPlotItem(size=9)
        for item in (self.original, self.asked, self.reached, self.dot):
            self.view.addItem(item, ignoreBounds=True)
        self.dot.hide()
        least = LEAST_WEIGHT if self.curve.is_weight else LEAST_MM
        self.removed, self.differing = Removed(self.view, least), Removed(self.view, least, differs=True)
        self._difference: tuple[tuple[Take, Take], Array, float] | None = None  # of which takes; how much, full scale
        self._removed_colour = QColor("white")
        self.range = self._fitted = (0.0, 1.0)
        self._box = QRectF(GUTTER_PX, 0.0, 1.0, 1.0)
        self._curves: tuple[Thinned, Thinned, Thinned | None] | None = None  # original, reached, asked

    def place(self, box: QRectF) -> None:
        """Put the curves into a box of the scene, and the name beside it."""
        self._box = box
        self.view.setGeometry(box)
        self.gutter.setGeometry(QRectF(0.0, box.top(), GUTTER_PX, box.height()))

    def hide_plots(self) -> None:
        """Take it off the screen, to be shown again; what it drew is not kept up to date meanwhile."""
        self.view.hide()
        self.gutter.hide()
        self.dot.hide()
        self._curves = None

    def paint_with(self, colours: Palette, line_px: float = 1.0) -> None:
        """Take on a theme's colours; lines are `line_px` pixels of the screen wide, which may be finer than the window's."""
        weight = self.key >= FIRST_WEIGHT
        colour = QColor(colours.quiet if weight else colours.lanes[self.key % len(colours.lanes)])
        self.original.set_pen(pg.mkPen(colours.faint, width=line_px))
        self.asked.set_pen(pg.mkPen(colours.text, width=line_px, style=Qt.PenStyle.DashLine))
        self.reached.set_pen(pg.mkPen(colour, width=line_px))
        self.removed.paint_with(colours, line_px)
        self.differing.paint_with(colours, line_px)
        self.dot.setBrush(pg.mkBrush(colour))
        self.dot.setPen(pg.mkPen(colours.text, width=line_px))
        self.gutter.colour, self.gutter.quiet = colour, QColor(colours.quiet)
        self.gutter.text_colour = QColor(colours.text)
        self.gutter.removed_colour = self._removed_colour = QColor(colours.warning)

    def fit(self) -> None:
        """Choose the range of values so that all curves fit with a margin; weights show 0..1."""
        assert self._curves is not None
        ranges = np.array([thinned.range for thinned in self._curves if thinned is not None])
        low, high = float(np.fmin.reduce(ranges[:, 0])), float(np.fmax.reduce(ranges[:, 1]))
        if self.curve.is_weight:
            low, high = min(0.0, low), max(1.0, high)
            self.gutter.range = (low, high)
            self._set_fitted(low - 0.06, high + 0.06)
            return
        spare = max(0.08 * (high - low), (4.0 - (high - low)) / 2, 0.2)
        self.gutter.range = (low, high)
        self._set_fitted(low - spare, high + spare)

    def _make_room(self, spare: float) -> None:
        if spare != self.gutter.spare:
            self.gutter.spare = spare
            self._set_fitted(*self._fitted)

    def _set_fitted(self, low: float, high: float) -> None:
        self._fitted = (low, high)
        spare = self.gutter.spare
        self.set_range(low - spare / (1 - spare) * (high - low), high)

    def set_range(self, low: float, high: float) -> None:
        """Show values between two bounds, in mm."""
        self.range = (low, high)
        self.view.setYRange(low, high, padding=0)

    def show_frames(self, first: float, last: float) -> None:
        """Show frames between two bounds."""
        self.view.setXRange(first, last, padding=0)

    def take_curves(self, original: Array, reached: Array, asked: Array | None, *, touched: tuple[int, int]) -> None:
        """Show other curves, (frames,) each; where the original is the same one, the rest differs in `touched` at most."""
        if self._curves is not None and self._curves[0].stands_for(original):
            for thinned, curve in zip(self._curves[1:], (reached, asked), strict=True):
                if thinned is not None and curve is not None:
                    thinned.changed_to(curve, touched)
        else:
            first = Thinned(original)
            second = first.copy() if first.stands_for(reached) else Thinned(reached)
            self._curves = first, second, None if asked is None else Thinned(asked)

    def draw_original(self, visible: tuple[int, int]) -> None:
        """Draw the curve as opened, a half-open range of frames."""
        assert self._curves is not None
        self.original.set_points(*self._curves[0].peaks(*visible, self._columns))

    def draw_edit(self, visible: tuple[int, int], draft: Rows | None = None, draft_asked: Rows | None = None) -> None:
        """Draw what was asked, if anything, and what the face does, with a draft over them."""
        assert self._curves is not None
        _, reached, asked = self._curves
        if asked is not None:
            self.asked.set_points(*asked.peaks(*visible, self._columns, draft_asked))
        self.reached.set_points(*reached.peaks(*visible, self._columns, draft))

    def draw_removed(self, taken_off: Array, start: int, *, kept: Mask, visible: tuple[int, int]) -> None:
        """Draw what cleaning takes off, (n,) from `start`, at the foot of the lane; `kept` are frames with a face."""
        self._make_room(removed.SHARE)
        full = self.removed.show(taken_off, start, kept=kept, visible=visible, columns=self._columns)
        unit = "" if self.curve.is_weight else f" {self.curve.unit}"
        self.gutter.removed_short = f"±{full:g}{unit}"
        self.gutter.removed = f"{REMOVED}{self.gutter.removed_short}"
        self.gutter.update()

    def difference(self, takes: tuple[Take, Take], measure: Callable[[], Array]) -> Array:
        """Return how much a curve differs, (frames,), measured once for the same two takes."""
        known = self._difference[0] if self._difference is not None else (None, None)
        if self._difference is None or known[0] is not takes[0] or known[1] is not takes[1]:
            curve = measure()
            least = LEAST_WEIGHT if self.curve.is_weight else LEAST_MM
            largest = float(np.abs(curve).max(initial=0.0))  # less than can be read is none
            self._difference = takes, curve, full_scale(largest, least) if largest >= least / 2 else 0.0
        return self._difference[1]

    def draw_difference(self, visible: tuple[int, int], frame: int) -> None:
        """Draw at the foot of the lane how much its curve differs, and write the difference at a frame."""
        assert self._difference is not None
        _, curve, full = self._difference
        if not full:
            self.hide_removed()
            return
        self._make_room(removed.SHARE)
        self.differing.draw(curve, 0, full=full, visible=visible, columns=self._columns)
        self.tell_difference(frame)

    def tell_difference(self, frame: int) -> None:
        """Write by how much the curve differs at a frame."""
        _, curve, full = self._difference or (None, np.zeros(0), 0.0)
        if not full:
            return
        unit = "" if self.curve.is_weight else f" {self.curve.unit}"
        digits = 2 if self.curve.is_weight else 1
        self.gutter.removed = f"Δ {curve[frame]:+.{digits}f} of ±{full:g}{unit}"
        self.gutter.removed_short = f"Δ {curve[frame]:+.{digits}f}"
        self.gutter.removed_colour = self.gutter.quiet
        self.gutter.update()

    def hide_removed(self) -> None:
        """Give the foot of the lane back to its curve."""
        self._make_room(0.0)
        self.removed.hide()
        self.differing.hide()
        self.gutter.removed_colour = self._removed_colour
        self.gutter.removed = ""
        self.gutter.update()

    @property
    def _columns(self) -> int:
        return max(64, int(self._box.width()))

    def scene_box(self) -> QRectF:
        """Return the box that the curves are drawn in, in the scene."""
        return QRectF(self._box)

    def frame_at(self, x: float) -> float:
        """Return the fractional frame at a scene position."""
        box = self.scene_box()
        (first, last), _ = self.view.viewRange()
        return float(first + (x - box.left()) / max(1.0, box.width()) * (last - first))

    def value_at(self, y: float) -> float:
        """Return the value in mm at a scene position."""
        box = self.scene_box()
        low, high = self.range
        return high - (y - box.top()) / max(1.0, box.height()) * (high - low)

    def y_of(self, value: float) -> float:
        """Return the scene position of a value in mm."""
        box = self.scene_box()
        low, high = self.range
        return box.top() + (high - value) / (high - low) * box.height()

    def x_of(self, frame: float) -> float:
        """Return the scene position of a frame."""
        box = self.scene_box()
        (first, last), _ = self.view.viewRange()
        return float(box.left() + (frame - first) / max(1e-9, last - first) * box.width())
