"""The lanes together: what is drawn when, and which tool the mouse goes to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import pyqtgraph as pg
from PySide6.QtCore import QEvent, QPoint, QPointF, QRectF, QSizeF, Qt, Signal
from PySide6.QtGui import QContextMenuEvent, QFocusEvent, QMouseEvent, QResizeEvent, QWheelEvent

from app.curves.drawing import (
    draw_differences,
    draw_edits,
    draw_removed,
    show_frames,
    take_curves,
    tell_differences,
)
from app.curves.lane import Lane
from app.curves.overlay import FocusRing, Playhead, Underlay
from app.curves.places import GUTTER_PX, Growth
from app.curves.stack import LaneStack
from app.curves.tools import make_tools
from app.curves.tools.base import Tool
from app.session import Change, Session
from app.session.edits import Editing
from app.theme import Palette
from app.widgets.text import Label

WHEEL_STEP = 1.2
MIN_LANE_PX = 40
EXPANDER = 0.75  # the part of the gutter whose click shows or hides the weights below


ANY_CURVE = Change.TAKE | Change.LANES | Change.VIEW | Change.CURVES | Change.DRAFT


class CurvesPanel(pg.GraphicsView):  # type: ignore[misc]
    """One lane per curve: the controls, and the weights under those that are expanded.

    Parameters
    ----------
    session : whose curves are shown
    inference : where a tool's asked curves go
    """

    menu_wanted = Signal(str, QPoint)  # curve, lane, or here for all that is at the playhead; where on the screen

    def __init__(self, session: Session, inference: Editing, colours: Palette) -> None:
        super().__init__()
        self.session, self.inference = session, inference
        self.setAntialiasing(True)
        self.setMouseTracking(True)
        self.setAccessibleName("Curves")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self._colours = colours
        self.stack = LaneStack(self.scene())
        self._growth = Growth()
        self._growth.moved.connect(self._place)
        self._underlay = Underlay(self.stack.box, self._x_of)
        self._playhead = Playhead(self.stack.box, self._x_of)
        self._ring = FocusRing(self._active_box, self._x_of)
        for item in (self._underlay, self._playhead, self._ring):
            self.scene().addItem(item)
        self.readout = Label("", self)
        self.readout.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.readout.hide()
        self.tools = make_tools(self)
        self._pan_from: tuple[QPointF, tuple[float, float]] | None = None
        self._named: int | None = None  # the lane whose name is pressed
        session.changed.connect(self._on_change)
        self._on_change(Change.TAKE)
        self.paint_with(colours)

    @property
    def tool(self) -> Tool:
        """The tool that the mouse goes to."""
        return self.tools[self.session.view.tool]

    @property
    def moving(self) -> bool:
        """Whether lanes are on their way to other places."""
        return self._growth.moving

    @property
    def lanes(self) -> list[Lane]:
        """The lanes on screen, from top to bottom."""
        return self.stack.shown

    def lane(self, key: int) -> Lane:
        """Return the lane of a curve on screen, an index into CURVES."""
        return self.stack.known[key]

    def paint_with(self, colours: Palette) -> None:
        """Take on a theme's colours."""
        self._colours = colours
        self.setBackground(colours.panel)
        self._paint_lanes()
        self._underlay.colours = self._playhead.colours = self._ring.colours = colours
        self.readout.setStyleSheet(
            f"background: {colours.raised}; color: {colours.text}; border: 1px solid {colours.edge};"
            "border-radius: 4px; padding: 3px 6px;"
        )

    def _paint_lanes(self) -> None:
        self.stack.paint_with(self._colours, self.devicePixelRatioF())  # pens that do not scale would be hairlines

    # --- drawing

    def _on_change(self, change: Change) -> None:
        kinds = Change
        for cause, step in (
            (kinds.TAKE | kinds.LANES, self._cancel_gesture),
            (kinds.TAKE | kinds.LANES, self._lay_lanes),
            (kinds.TAKE | kinds.LANES | kinds.CURVES, partial(self._draw, take_curves)),
            (kinds.TAKE | kinds.LANES | kinds.LANE, self._arrange),
            (kinds.TAKE | kinds.LANES | kinds.VIEW, partial(self._draw, show_frames)),
            (kinds.TAKE | kinds.LANES | kinds.VIEW | kinds.CURVES | kinds.DRAFT, partial(self._draw, draw_edits)),
            (
                kinds.TAKE | kinds.LANES | kinds.VIEW | kinds.CURVES | kinds.DRAFT | kinds.TOOL,
                partial(self._draw, draw_removed),
            ),
            (ANY_CURVE | kinds.TOOL | kinds.REVIEW, partial(self._draw, draw_differences)),
            (kinds.PLAYHEAD, partial(self._draw, tell_differences)),
            (kinds.TAKE | kinds.LANES | kinds.PLAYHEAD | kinds.CURVES | kinds.DRAFT, self._show_playhead),
            (kinds.LANES | kinds.CURVES | kinds.DRAFT, self.tool.leave),  # what it showed is not there any more
            (kinds.DRAFT, self.tool.refresh),
            (kinds.TAKE | kinds.TOOL, self._take_up_tool),
            (kinds.TAKE | kinds.LANES | kinds.TOOL | kinds.VIEW | kinds.SELECTION | kinds.MARKS, self._show_marks),
            (kinds.CURVES, self._show_marks),  # a fill that is kept is no span to work on any more
            (kinds.VIEW | kinds.SELECTION, self._follow),
        ):
            if change & cause:
                step()

    def _draw(self, step: Callable[[Sequence[Lane], Session], None]) -> None:
        step(self.lanes, self.session)

    def _show_marks(self) -> None:
        self._underlay.selection = self.session.view.selection
        self._underlay.spans = [(float(span.start), float(span.stop)) for span in self.session.document.open_spans]
        notes = self.session.document.marks.notes
        self._underlay.notes = [(float(note.frame), float(note.stop)) for note in notes if not note.resolved]
        self._underlay.update()
        self._playhead.update()

    def _cancel_gesture(self) -> None:
        """Drop a gesture whose take or lane is gone: it may not be there any more."""
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
        if self.stack.show(self.session.view.lanes):
            self._paint_lanes()

    def _place(self) -> None:
        """Put every lane where the panel's size has it."""
        self.stack.place(QSizeF(self.size()), self._growth.shares)
        for item in (self._underlay, self._playhead, self._ring):
            item.moved()
        self._follow()

    def _follow(self) -> None:
        """Let what the tool shows be where the lanes are."""
        self.tool.placed()

    def _arrange(self) -> None:
        active = self.session.view.lane
        self.stack.mark(active, self.session.view.expanded)
        self._ring.moved()
        self._growth.choose(self.stack.keys, active, at_once=not self.isVisible())
        self.setMinimumHeight(MIN_LANE_PX * len(self.lanes))

    def _show_playhead(self) -> None:
        frame = self.session.view.playhead
        self._playhead.frame = frame
        self._playhead.update()
        for lane in self.lanes:
            lane.gutter.value = self.session.document.value(lane.key, frame)
            lane.gutter.update()

    def show_brush(self, lane: Lane | None, frames: tuple[float, float] | None) -> None:
        """Tint the frames that a tool would move, in one lane."""
        self._underlay.brush_reach = frames
        self._underlay.brush_box = lane.scene_box if lane else QRectF
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

    def _active_box(self) -> QRectF:
        """Return the box of the lane that is worked on, its name included; an empty one without the keyboard."""
        shown = next((lane for lane in self.lanes if lane.key == self.session.view.lane), None)
        if shown is None or not self.hasFocus():
            return QRectF()
        return shown.scene_box().adjusted(-GUTTER_PX, 0, 0, 0)

    def _x_of(self, frame: float) -> float:
        return self.stack.x_of(frame, self.session.view.range)

    def lane_at(self, at: QPointF) -> int | None:
        """Return the curve whose lane is under a position in the widget, gutter included."""
        return self.stack.at(self.mapToScene(at.toPoint()).y())

    def frame_at(self, at: QPointF) -> float:
        """Return the fractional frame under a position in the widget."""
        return self.lanes[0].frame_at(self.mapToScene(at.toPoint()).x())

    # --- the mouse

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Pass the press to the tool; the middle button pans; the lanes do not scroll until the button is released."""
        self._growth.hold()
        if event.button() == Qt.MouseButton.MiddleButton:
            self._pan_from = (event.position(), self.session.view.range)
            return
        lane = self.lane_at(event.position())
        if event.button() != Qt.MouseButton.LeftButton or lane is None:
            return
        self.session.view.choose_lane(lane)
        if event.position().x() < GUTTER_PX:
            self._named = lane
        else:
            self.tool.press(lane, event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Pan, or let the tool move."""
        if not event.buttons():
            self._released()  # elsewhere, if there was a press
        if self._pan_from is not None:
            origin, (first, last) = self._pan_from
            shift = (origin.x() - event.position().x()) / max(1.0, self.stack.box().width()) * (last - first)
            self.session.view.set_range(first + shift, last + shift)
            return
        in_gutter = event.position().x() < GUTTER_PX and not self.tool.busy
        self.setCursor(Qt.CursorShape.PointingHandCursor if in_gutter else self.tool.cursor)
        if in_gutter:
            self.tool.leave()
        else:
            self.tool.move(self.lane_at(event.position()), event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End what the press began."""
        named, self._named = self._named, None
        if event.button() == Qt.MouseButton.MiddleButton:
            self._pan_from = None
        elif event.button() == Qt.MouseButton.LeftButton:
            self.tool.release(event)
            at = event.position()
            if named is not None and at.x() < GUTTER_PX * EXPANDER and self.lane_at(at) == named:
                self.session.view.expand(named)
        if not event.buttons():
            self._released()

    def _released(self) -> None:
        self._pan_from = self._named = None
        self._growth.release()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Offer what can be done with a curve and go there; with the menu key, at the playhead of the active lane."""
        event.accept()
        if self.tool.busy:
            return
        at, lane = QPointF(event.pos()), self.lane_at(QPointF(event.pos()))
        if event.reason() == QContextMenuEvent.Reason.Keyboard:
            box = self.lane(self.session.view.lane).scene_box()
            place = QPointF(min(max(self._x_of(self.session.view.playhead), box.left()), box.right()), box.center().y())
            self.menu_wanted.emit("here", self.mapToGlobal(self.mapFromScene(place)))
        elif lane is not None:
            self.session.view.choose_lane(lane)
            if at.x() >= GUTTER_PX:
                self.session.view.move_playhead(round(self.frame_at(at)))
            self.menu_wanted.emit("curve" if at.x() >= GUTTER_PX else "lane", event.globalPos())

    def leaveEvent(self, event: object) -> None:
        """Put hints away with the pointer."""
        self.tool.leave()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Scroll the lanes; with Ctrl zoom around the pointer; sideways or with Shift pan; else change the tool's size."""
        turn = event.angleDelta()
        notches = (turn.y() or turn.x()) / 120.0
        if event.buttons() & Qt.MouseButton.LeftButton or event.modifiers() & Qt.KeyboardModifier.AltModifier:
            self.tool.wheel(notches)
        elif event.modifiers() & Qt.KeyboardModifier.ShiftModifier or abs(turn.x()) > abs(turn.y()):
            first, last = self.session.view.range
            shift = -notches * 0.1 * (last - first)
            self.session.view.set_range(first + shift, last + shift)
        elif event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            self.session.view.zoom(WHEEL_STEP**notches, self.frame_at(event.position()))
        else:
            event.ignore()  # for the scroll area around the lanes
            return
        event.accept()

    # --- the panel itself

    def resizeEvent(self, event: QResizeEvent | None) -> None:
        """Place the lanes, and thin the curves, for the new size."""
        super().resizeEvent(event)
        if event is not None:  # pyqtgraph sends none while it is built
            self._place()
            for step in (show_frames, draw_edits, draw_removed, draw_differences):
                self._draw(step)

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Show where the keys go."""
        super().focusInEvent(event)
        self._ring.moved()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Show that they go elsewhere."""
        super().focusOutEvent(event)
        self._ring.moved()

    def event(self, event: QEvent) -> bool:
        """Draw lines as wide as before on a screen of another resolution."""
        if event.type() == QEvent.Type.DevicePixelRatioChange:
            self._paint_lanes()
        return bool(super().event(event))
