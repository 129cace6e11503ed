"""The lanes together: what is drawn when, and which tool the mouse goes to."""

from __future__ import annotations

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QMouseEvent, QResizeEvent, QWheelEvent
from PySide6.QtWidgets import QLabel

from app.curves.lane import Lane
from app.curves.overlay import Playhead, Underlay
from app.curves.peaks import on_screen
from app.curves.tools import DragTool, Tool
from app.inference import Inference
from app.session import Change, Session
from app.theme import GRID, Palette
from engine.controls import CONTROLS
from engine.take import Array, runs

ACTIVE_STRETCH, STRETCH = 24, 10
WHEEL_STEP = 1.2


class CurvesPanel(pg.GraphicsLayoutWidget):  # type: ignore[misc]
    """One lane per control.

    Parameters
    ----------
    session : whose curves are shown
    inference : where a tool's asked curves go
    """

    def __init__(self, session: Session, inference: Inference, colours: Palette) -> None:
        super().__init__()
        self.session, self.inference = session, inference
        self.setAntialiasing(True)
        self.setMouseTracking(True)
        self.setAccessibleName("Control curves")
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        self.ci.layout.setContentsMargins(0, 0, GRID, 0)
        self.ci.layout.setVerticalSpacing(6)
        self.ci.layout.setHorizontalSpacing(0)
        self.lanes = [Lane(control) for control in CONTROLS]
        for row, lane in enumerate(self.lanes):
            self.ci.addItem(lane.gutter, row, 0)
            self.ci.addItem(lane.view, row, 1)
        self._underlay = Underlay(self._lanes_box, self._x_of)
        self._playhead = Playhead(self._lanes_box, self._x_of)
        self.scene().addItem(self._underlay)
        self.scene().addItem(self._playhead)
        self.readout = QLabel(self)
        self.readout.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.readout.hide()
        self.tool: Tool = DragTool(self)
        self._pan_from: tuple[QPointF, tuple[float, float]] | None = None
        self.paint_with(colours)
        session.changed.connect(self._on_change)
        self._on_change(Change.TAKE)

    def paint_with(self, colours: Palette) -> None:
        """Take on a theme's colours."""
        self.setBackground(colours.panel)
        for index, lane in enumerate(self.lanes):
            lane.paint_with(colours, index)
        self._underlay.colours = colours
        self._playhead.colour = QColor(colours.text)
        self.readout.setStyleSheet(
            f"background: {colours.raised}; color: {colours.text}; border: 1px solid {colours.edge};"
            "border-radius: 4px; padding: 3px 6px;"
        )

    # --- drawing

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.CURVES):
            self._fit_values()
        if change & (Change.TAKE | Change.LANE):
            self._arrange()
        if change & (Change.TAKE | Change.VIEW):
            for lane in self.lanes:
                lane.show_frames(*self.session.view)
            self._draw(originals=True)
        elif change & (Change.CURVES | Change.DRAFT):
            self._draw()
        if change & (Change.TAKE | Change.PLAYHEAD | Change.CURVES | Change.DRAFT):
            self._show_playhead()
        if change & (Change.TAKE | Change.SELECTION):
            self._underlay.selection = self.session.selection
            self._underlay.spans = [(float(a), float(b)) for a, b in runs(self.session.take.lost)]
        if change & (Change.TOOL | Change.TAKE | Change.VIEW | Change.SELECTION | Change.LANE):
            self._underlay.update()
            self._playhead.update()

    def _fit_values(self) -> None:
        session = self.session
        for index, lane in enumerate(self.lanes):
            asked = session.asked[:, index]
            curves = [session.original_controls[:, index], session.controls[:, index]]
            lane.fit(*curves, *([asked] if np.isfinite(asked).any() else []))

    def _arrange(self) -> None:
        for row, lane in enumerate(self.lanes):
            lane.gutter.active = row == self.session.lane
            self.ci.layout.setRowStretchFactor(row, ACTIVE_STRETCH if lane.gutter.active else STRETCH)
            lane.gutter.update()

    def _draw(self, *, originals: bool = False) -> None:
        session, draft = self.session, self.session.draft
        start, stop = on_screen(len(session.take), session.view)
        asked, reached = session.asked[start:stop], session.controls[start:stop]
        if draft is not None:
            asked = _overlaid(asked, start, draft.asked, draft.start)
            reached = _overlaid(reached, start, draft.reached, draft.start)
        for index, lane in enumerate(self.lanes):
            if originals:
                lane.draw_original(session.original_controls[start:stop, index], start)
            lane.draw_edit(asked[:, index], reached[:, index], start)

    def _show_playhead(self) -> None:
        frame = self.session.playhead
        self._playhead.frame = frame
        self._playhead.update()
        for lane, value in zip(self.lanes, self.session.shown_controls(frame), strict=True):
            lane.gutter.value = float(value)
            lane.gutter.update()

    def show_brush(self, lane: Lane | None, frames: tuple[float, float] | None) -> None:
        """Tint the frames that a tool would move, in one lane."""
        self._underlay.brush_reach = frames
        self._underlay.brush_box = lane.scene_box() if lane else QRectF()
        self._underlay.update()

    def show_dot(self, lane: Lane | None, frame: float = 0.0, value: float = 0.0) -> None:
        """Show the handle on a lane's curve, or none."""
        for other in self.lanes:
            other.dot.setData([frame], [value]) if other is lane else other.dot.clear()

    def show_readout(self, text: str, at: QPointF) -> None:
        """Show a short text beside the pointer, kept inside the panel; nothing for an empty one."""
        self.readout.setVisible(bool(text))
        self.readout.setText(text)
        self.readout.adjustSize()
        x = min(at.x() + 14, self.width() - self.readout.width() - 4)
        y = max(4.0, at.y() - self.readout.height() - 8)
        self.readout.move(int(x), int(y))

    # --- geometry

    def _lanes_box(self) -> QRectF:
        return self.lanes[0].scene_box().united(self.lanes[-1].scene_box())

    def _x_of(self, frame: float) -> float:
        box = self.lanes[0].scene_box()
        first, last = self.session.view
        return box.left() + (frame - first) / max(1e-9, last - first) * box.width()

    def lane_at(self, at: QPointF) -> int | None:
        """Return the lane under a position in the widget, gutter included."""
        y = self.mapToScene(at.toPoint()).y()
        for index, lane in enumerate(self.lanes):
            box = lane.scene_box()
            if box.top() - 3 <= y < box.bottom() + 3:
                return index
        return None

    def frame_at(self, at: QPointF) -> float:
        """Return the fractional frame under a position in the widget."""
        return self.lanes[0].frame_at(self.mapToScene(at.toPoint()).x())

    def shown_curve(self, lane: int) -> Array:
        """Return what the face does, (frames,) in mm, in a lane, edits under way left out."""
        return self.session.controls[:, lane]

    # --- the mouse

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Give the press to the tool; the middle button pans."""
        if event.button() == Qt.MouseButton.MiddleButton:
            self._pan_from = (event.position(), self.session.view)
            return
        lane = self.lane_at(event.position())
        if event.button() == Qt.MouseButton.LeftButton and lane is not None:
            self.session.choose_lane(lane)
            self.ci.layout.activate()
            self.tool.press(lane, event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Pan, or let the tool move."""
        if self._pan_from is not None:
            origin, (first, last) = self._pan_from
            shift = (origin.x() - event.position().x()) / max(1.0, self._lanes_box().width()) * (last - first)
            self.session.set_view(first + shift, last + shift)
            return
        self.tool.move(self.lane_at(event.position()), event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End what the press began."""
        if event.button() == Qt.MouseButton.MiddleButton:
            self._pan_from = None
        elif event.button() == Qt.MouseButton.LeftButton:
            self.tool.release(event)

    def leaveEvent(self, event: object) -> None:
        """Put hints away with the pointer."""
        self.tool.leave()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom around the pointer; sideways or with Shift pan; while a button is held the tool's size changes."""
        turn = event.angleDelta()
        notches = (turn.y() or turn.x()) / 120.0
        if event.buttons() & Qt.MouseButton.LeftButton or event.modifiers() & Qt.KeyboardModifier.AltModifier:
            self.tool.wheel(notches)
        elif event.modifiers() & Qt.KeyboardModifier.ShiftModifier or abs(turn.x()) > abs(turn.y()):
            first, last = self.session.view
            shift = -notches * 0.1 * (last - first)
            self.session.set_view(first + shift, last + shift)
        else:
            self.session.zoom_view(WHEEL_STEP**notches, self.frame_at(event.position()))
        event.accept()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Thin the curves for the new width."""
        super().resizeEvent(event)
        if hasattr(self, "tool"):
            self._draw(originals=True)


def _overlaid(visible: Array, start: int, rows: Array, rows_start: int) -> Array:
    """Return visible, (n, 8) from frame `start`, with rows from `rows_start` over it."""
    first, last = max(start, rows_start), min(start + len(visible), rows_start + len(rows))
    if first >= last:
        return visible
    merged = visible.copy()
    merged[first - start : last - start] = rows[first - rows_start : last - rows_start]
    return merged
