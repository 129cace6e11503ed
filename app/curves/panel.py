"""The lanes together: what is drawn when, and which tool the mouse goes to."""

from __future__ import annotations

import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QMouseEvent, QResizeEvent, QWheelEvent
from PySide6.QtWidgets import QLabel

from app.curves.lane import GUTTER_PX, Lane
from app.curves.overlay import Playhead, Underlay
from app.curves.peaks import on_screen
from app.curves.tools import make_tools
from app.curves.tools.base import Tool
from app.session import Change, Session
from app.session.inference import Inference
from app.theme import GRID, Palette

ACTIVE_STRETCH, STRETCH = 24, 10
WHEEL_STEP = 1.2
MIN_LANE_PX = 40
EXPANDER = 0.75  # the part of the gutter whose click shows or hides the weights below


class CurvesPanel(pg.GraphicsLayoutWidget):  # type: ignore[misc]
    """One lane per curve: the controls, and the weights under those that are expanded.

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
        self.setAccessibleName("Curves")
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        self.ci.layout.setContentsMargins(0, 0, GRID, 0)
        self.ci.layout.setVerticalSpacing(6)
        self.ci.layout.setHorizontalSpacing(0)
        self._colours = colours
        self.lanes: list[Lane] = []
        self._made: dict[int, Lane] = {}  # by key; a lane that leaves the scene is kept: Qt may yet paint it once
        self._underlay = Underlay(self._lanes_box, self._x_of)
        self._playhead = Playhead(self._lanes_box, self._x_of)
        self.scene().addItem(self._underlay)
        self.scene().addItem(self._playhead)
        self.readout = QLabel(self)
        self.readout.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.readout.hide()
        self.tools = make_tools(self)
        self._pan_from: tuple[QPointF, tuple[float, float]] | None = None
        session.changed.connect(self._on_change)
        self._on_change(Change.TAKE)
        self.paint_with(colours)

    @property
    def tool(self) -> Tool:
        """The tool that the mouse goes to."""
        return self.tools[self.session.tool]

    def lane(self, key: int) -> Lane:
        """Return the lane of a curve on screen, an index into CURVES."""
        return self.lanes[self.session.lanes.index(key)]

    def paint_with(self, colours: Palette) -> None:
        """Take on a theme's colours."""
        self._colours = colours
        self.setBackground(colours.panel)
        for lane in self.lanes:
            lane.paint_with(colours)
        self._underlay.colours = self._playhead.colours = colours
        self.readout.setStyleSheet(
            f"background: {colours.raised}; color: {colours.text}; border: 1px solid {colours.edge};"
            "border-radius: 4px; padding: 3px 6px;"
        )

    # --- drawing

    def _on_change(self, change: Change) -> None:
        kinds = Change
        for cause, step in (
            (kinds.TAKE, self._let_go),
            (kinds.TAKE | kinds.LANES, self._lay_lanes),
            (kinds.TAKE | kinds.LANES | kinds.CURVES, self._take_curves),
            (kinds.TAKE | kinds.LANES | kinds.CURVES, self._fit_values),
            (kinds.TAKE | kinds.LANES | kinds.LANE, self._arrange),
            (kinds.TAKE | kinds.LANES | kinds.VIEW, self._show_frames),
            (kinds.TAKE | kinds.LANES | kinds.VIEW | kinds.CURVES | kinds.DRAFT, self._draw_edits),
            (kinds.TAKE | kinds.LANES | kinds.VIEW | kinds.CURVES | kinds.DRAFT | kinds.TOOL, self._draw_removed),
            (kinds.TAKE | kinds.LANES | kinds.PLAYHEAD | kinds.CURVES | kinds.DRAFT, self._show_playhead),
            (kinds.LANES | kinds.CURVES | kinds.DRAFT, self.tool.leave),  # what it showed is not there any more
            (kinds.DRAFT, self.tool.refresh),
            (kinds.TAKE | kinds.TOOL, self._take_up_tool),
            (kinds.TAKE | kinds.LANES | kinds.TOOL | kinds.VIEW | kinds.SELECTION | kinds.MARKS, self._show_marks),
        ):
            if change & cause:
                step()

    def _show_marks(self) -> None:
        self._underlay.selection = self.session.selection
        self._underlay.spans = [(float(span.start), float(span.stop)) for span in self.session.marks.spans]
        self._underlay.update()
        self._playhead.update()

    def _let_go(self) -> None:
        """Drop a gesture whose take is gone: its frames may not be there any more."""
        if self.tool.busy:
            self.tool.cancel()

    def _take_up_tool(self) -> None:
        for tool in self.tools.values():
            if tool is not self.tool and tool.busy:
                tool.cancel()
        self.show_handles(QRectF(), [])
        self.tool.leave()
        self.setCursor(self.tool.cursor)

    def _lay_lanes(self) -> None:
        wanted = self.session.lanes
        if [lane.key for lane in self.lanes] == wanted:
            return
        self.ci.clear()
        for key in wanted:
            if key not in self._made:
                self._made[key] = Lane(key)
        self.lanes = [self._made[key] for key in wanted]
        for row, lane in enumerate(self.lanes):
            lane.paint_with(self._colours)
            self.ci.addItem(lane.gutter, row, 0)
            self.ci.addItem(lane.view, row, 1)
        self.ci.setGeometry(self.range)  # else they have no width until the panel's size changes
        self._take_curves()  # growing draws them already
        self.setMinimumHeight(MIN_LANE_PX * len(self.lanes))

    def _take_curves(self) -> None:
        for lane in self.lanes:
            lane.take_curves(
                self.session.original_curve(lane.key),
                self.session.curve(lane.key),
                self.session.asked_curve(lane.key),
                touched=self.session.touched,
            )

    def _fit_values(self) -> None:
        for lane in self.lanes:
            lane.fit()

    def _arrange(self) -> None:
        for row, lane in enumerate(self.lanes):
            lane.gutter.active = lane.key == self.session.lane
            lane.gutter.expanded = lane.key in self.session.expanded
            self.ci.layout.setRowStretchFactor(row, ACTIVE_STRETCH if lane.gutter.active else STRETCH)
            lane.gutter.update()
        self.ci.layout.activate()

    def _show_frames(self) -> None:
        start, stop = on_screen(len(self.session.take), self.session.view)
        for lane in self.lanes:
            lane.show_frames(*self.session.view)
            lane.draw_original((start, stop))

    def _draw_edits(self) -> None:
        session, draft = self.session, self.session.draft
        start, stop = on_screen(len(session.take), session.view)
        for lane in self.lanes:
            drafted = session.draft_curve(lane.key)
            if draft is None or drafted is None:
                lane.draw_edit((start, stop))
            else:
                asked = None if lane.curve.is_weight else (draft.asked[:, lane.curve.column], draft.start)
                lane.draw_edit((start, stop), (drafted, draft.start), asked)

    def _draw_removed(self) -> None:
        session, draft = self.session, self.session.draft
        wanted = session.tool == "clean" and session.shows_removed
        visible = on_screen(len(session.take), session.view)
        for lane in self.lanes:
            drafted = session.draft_curve(lane.key) if wanted else None
            if draft is None or drafted is None:
                lane.hide_removed()
                continue
            rows = slice(draft.start, draft.stop)
            kept = ~session.take.lost[rows]
            lane.draw_removed(session.curve(lane.key)[rows] - drafted, draft.start, kept=kept, visible=visible)

    def _show_playhead(self) -> None:
        frame = self.session.playhead
        self._playhead.frame = frame
        self._playhead.update()
        for lane in self.lanes:
            lane.gutter.value = self.session.value(lane.key, frame)
            lane.gutter.update()

    def show_brush(self, lane: Lane | None, frames: tuple[float, float] | None) -> None:
        """Tint the frames that a tool would move, in one lane."""
        self._underlay.brush_reach = frames
        self._underlay.brush_box = lane.scene_box() if lane else QRectF()
        self._underlay.update()

    def show_dot(self, lane: Lane | None, frame: float = 0.0, value: float = 0.0) -> None:
        """Show the handle on a lane's curve, or none."""
        for other in self.lanes:
            other.dot.setVisible(other is lane)  # an empty one would be painted at every pan
            if other is lane:
                other.dot.setData([frame], [value])

    def show_handles(self, box: QRectF, handles: list[QPointF]) -> None:
        """Show a box with handles, in the scene; an empty box for none."""
        self._playhead.box, self._playhead.handles = box, handles
        self._playhead.update()

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
        """Return the curve whose lane is under a position in the widget, gutter included."""
        y = self.mapToScene(at.toPoint()).y()
        for lane in self.lanes:
            box = lane.scene_box()
            if box.top() - 3 <= y < box.bottom() + 3:
                return lane.key
        return None

    def frame_at(self, at: QPointF) -> float:
        """Return the fractional frame under a position in the widget."""
        return self.lanes[0].frame_at(self.mapToScene(at.toPoint()).x())

    # --- the mouse

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Give the press to the tool; the middle button pans."""
        if event.button() == Qt.MouseButton.MiddleButton:
            self._pan_from = (event.position(), self.session.view)
            return
        lane = self.lane_at(event.position())
        if event.button() != Qt.MouseButton.LeftButton or lane is None:
            return
        if event.position().x() < GUTTER_PX:
            self.session.choose_lane(lane)
            if event.position().x() < GUTTER_PX * EXPANDER:
                self.session.expand(lane)
            return
        self.session.choose_lane(lane)
        self.tool.press(lane, event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Pan, or let the tool move."""
        if self._pan_from is not None:
            origin, (first, last) = self._pan_from
            shift = (origin.x() - event.position().x()) / max(1.0, self._lanes_box().width()) * (last - first)
            self.session.set_view(first + shift, last + shift)
            return
        in_gutter = event.position().x() < GUTTER_PX and not self.tool.busy
        self.setCursor(Qt.CursorShape.PointingHandCursor if in_gutter else self.tool.cursor)
        if in_gutter:
            self.tool.leave()
        else:
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
        if self.isVisible():
            self._show_frames()
            self._draw_edits()
