"""The lanes on screen, from top to bottom: which there are, where each is, and which lies under a place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from PySide6.QtCore import QRectF, QSizeF
from PySide6.QtWidgets import QGraphicsScene

from app.curves.lane import Lane
from app.curves.places import boxes
from app.theme import Palette

NEAR_PX = 3  # of a lane's edge, that still count as in it


class LaneStack:
    """Keeps a lane for each curve that was ever on screen.

    Parameters
    ----------
    scene : in which they are drawn

    Attributes
    ----------
    shown : the lanes on screen
    known : all that were made, by key; a lane that leaves the screen is kept: Qt may yet paint it once
    """

    def __init__(self, scene: QGraphicsScene) -> None:
        self._scene = scene
        self.shown: list[Lane] = []
        self.known: dict[int, Lane] = {}

    @property
    def keys(self) -> list[int]:
        """The curves on screen, as indices into CURVES."""
        return [lane.key for lane in self.shown]

    def show(self, keys: Sequence[int]) -> bool:
        """Show the lanes of these curves and no others; returns whether that is another choice than before."""
        if self.keys == list(keys):
            return False
        for lane in self.shown:
            if lane.key not in keys:
                lane.hide_plots()
        for key in keys:
            if key not in self.known:
                self.known[key] = Lane(key)
                self._scene.addItem(self.known[key].gutter)
                self._scene.addItem(self.known[key].view)
        self.shown = [self.known[key] for key in keys]
        for lane in self.shown:
            lane.gutter.show()
            lane.view.show()
        return True

    def paint_with(self, colours: Palette, line_px: float) -> None:
        """Take on a theme's colours; lines are `line_px` pixels of the screen wide."""
        for lane in self.shown:
            lane.paint_with(colours, line_px)

    def place(self, size: QSizeF, shares: Mapping[int, float]) -> None:
        """Put every lane where a panel of this size, and the lanes' shares of its height, have it."""
        for lane, box in zip(self.shown, boxes(size, self.keys, shares), strict=True):
            lane.place(box)

    def mark(self, active: int, expanded: frozenset[int]) -> None:
        """Show in the gutter which lane is worked on, and which have their weights below them."""
        for lane in self.shown:
            lane.gutter.active = lane.key == active
            lane.gutter.expanded = lane.key in expanded
            lane.gutter.update()

    def box(self) -> QRectF:
        """Return the box of all lanes, in the scene."""
        return self.shown[0].scene_box().united(self.shown[-1].scene_box())

    def x_of(self, frame: float, on_screen: tuple[float, float]) -> float:
        """Return the place of a frame in the scene, where the first and the last frame on screen are these."""
        box, (first, last) = self.shown[0].scene_box(), on_screen
        return box.left() + (frame - first) / max(1e-9, last - first) * box.width()

    def at(self, y: float) -> int | None:
        """Return the curve whose lane is at a height of the scene."""
        for lane in self.shown:
            box = lane.scene_box()
            if box.top() - NEAR_PX <= y < box.bottom() + NEAR_PX:
                return lane.key
        return None
