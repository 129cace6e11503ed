"""What cleaning would take off a curve, drawn under it on a scale of its own: most of it is too small to see else."""

from __future__ import annotations

import numpy as np
import pyqtgraph as pg
from PySide6.QtGui import QColor

from app.curves.peaks import peaks
from app.theme import Palette
from engine.take import Array, Mask

SHARE = 0.34  # of a lane's height
TINT = 0.3
SCALED = 0.99  # of the frames are within the scale


def full_scale(largest: float, least: float) -> float:
    """Return the next of 1, 2, 5, 10, ... not below a value, nor below a least one: next to nothing must look so."""
    wanted = max(largest, least)
    decade = 10.0 ** np.floor(np.log10(wanted))
    return float(next(step * decade for step in (1, 2, 5, 10) if step * decade >= wanted * (1 - 1e-9)))


class Removed:
    """Raw minus cleaned as an area around a line.

    Parameters
    ----------
    view : of the lane
    least : of the scale, in the units of its values
    differs : whether it shows where two takes differ, in a colour that warns of nothing
    """

    def __init__(self, view: pg.ViewBox, least: float, *, differs: bool = False) -> None:
        self._view, self._least, self._differs = view, least, differs
        self.area, self.line = pg.PlotCurveItem(), pg.PlotCurveItem()
        for item in (self.line, self.area):
            view.addItem(item, ignoreBounds=True)
        self.hide()

    def paint_with(self, colours: Palette, line_px: float) -> None:
        """Take on a theme's colours; lines are `line_px` pixels of the screen wide."""
        name = colours.accent if self._differs else colours.warning
        colour, tint = QColor(name), QColor(name)
        tint.setAlphaF(TINT)
        self.area.setPen(pg.mkPen(colour, width=line_px))
        self.area.setBrush(pg.mkBrush(tint))
        self.line.setPen(pg.mkPen(colours.edge, width=line_px))

    def hide(self) -> None:
        """Show nothing."""
        for item in (self.area, self.line):
            item.setVisible(False)

    def show(self, removed: Array, start: int, *, kept: Mask, visible: tuple[int, int], columns: int) -> float:
        """Draw what is removed, (n,) from frame `start`, on the visible frames; returns the value of full scale.

        The scale is that of nearly all frames on which the tracker had a face, `kept`; the few beyond it are cut.
        """
        full = full_scale(float(np.quantile(np.abs(removed[kept]), SCALED)) if kept.any() else 0.0, self._least)
        self.draw(removed, start, full=full, visible=visible, columns=columns)
        return full

    def draw(self, removed: Array, start: int, *, full: float, visible: tuple[int, int], columns: int) -> None:
        """Draw a curve, (n,) from frame `start`, on the visible frames, with the value of full scale."""
        low, high = self._view.viewRange()[1]
        middle, reach = low + SHARE / 2 * (high - low), SHARE / 2 * 0.8 * (high - low)
        first, last = max(start, visible[0]), min(start + len(removed), visible[1])
        frames, values = peaks(removed[first - start : max(last, first) - start], first, columns)
        self.line.setData([start, start + len(removed) - 1], [middle, middle])
        self.area.setData(frames, middle + np.clip(values / full, -1.0, 1.0) * reach)
        self.area.setFillLevel(middle)
        for item in (self.area, self.line):
            item.setVisible(True)
