"""Scale: choose a box, then pull its handles to change amplitude or time."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QMouseEvent

from app.curves.brush import eased_to
from app.curves.tools.base import Tool
from app.session.curve_table import CURVES
from engine.take import Array
from engine.words import counted

HANDLE_PX = 9
JOIN_S = 0.15  # over which a stretch made longer joins what it runs into


def scaled_in_value(curve: Array, factor: float) -> Array:
    """Return a stretch of curve, (n,), with its amplitude scaled about the line between its ends, which stay."""
    line = np.linspace(curve[0], curve[-1], len(curve))
    return np.asarray(line + factor * (curve - line))


def scaled_in_time(curve: Array, start: int, stop: int, new_stop: int, *, join_frames: float) -> tuple[int, Array]:
    """Return the first frame and the rows, (n,), of a curve whose frames [start, stop) now last until `new_stop`.

    What the stretch leaves free is bridged by a straight line; what it runs into it joins over `join_frames`.
    """
    inside = np.interp(np.linspace(start, stop - 1, new_stop - start), np.arange(len(curve)), curve)
    if new_stop >= stop:
        return eased_to(curve, (start, new_stop), inside, before_frames=0.0, after_frames=join_frames)
    rows = curve[start:stop].copy()
    rows[: len(inside)] = inside
    rows[len(inside) - 1 :] = np.linspace(inside[-1], curve[stop - 1], stop - new_stop + 1)
    return start, rows


class ScaleTool(Tool):
    """Box-select a stretch of one curve; the top handle scales its amplitude, the right one its time."""

    cursor = Qt.CursorShape.CrossCursor

    def __init__(self, panel) -> None:  # type: ignore[no-untyped-def]
        super().__init__(panel)
        self._lane = 0
        self._held = ""  # "box", "value" or "time"
        self._pressed = QPointF()

    @property
    def busy(self) -> bool:
        """Whether a box or a handle is held."""
        return bool(self._held)

    def press(self, lane: int, event: QMouseEvent) -> None:
        """Take a handle, or begin a box."""
        if self.panel.inference.busy:
            return
        self._pressed = event.position()
        self._held = self._handle_at(event.position()) or "box"
        if self._held == "box":
            self._lane = lane
            self.panel.session.view.select(None)

    def move(self, lane: int | None, event: QMouseEvent) -> None:
        """Widen the box, or scale by the handle."""
        session, at = self.panel.session, event.position()
        if self._held == "box":
            first, last = sorted((round(self.panel.frame_at(self._pressed)), round(self.panel.frame_at(at))))
            session.view.select((first, last + 1))
        elif self._held:
            self._scale(at)
        else:
            self._hover(lane, at)
        self._show_box()

    def release(self, event: QMouseEvent) -> None:
        """Make the scaling one undo step; a box just stays."""
        held, self._held = self._held, ""
        if held in ("value", "time"):
            self.done("scale" if held == "value" else "retime", self._lane, event.position())
        self._show_box()

    def cancel(self) -> None:
        """Drop the scaling, or the box."""
        if self._held in ("value", "time"):
            self.panel.inference.cancel()
        elif not self._held:
            self.panel.session.view.select(None)
        self._held = ""
        self.leave()

    def leave(self) -> None:
        """Put the read-out away; the box stays."""
        super().leave()
        self._show_box()

    def placed(self) -> None:
        """Let the box follow what it is around."""
        self._show_box()

    def _hover(self, lane: int | None, at: QPointF) -> None:
        handle = self._handle_at(at)
        shapes = {"value": Qt.CursorShape.SizeVerCursor, "time": Qt.CursorShape.SizeHorCursor}
        self.panel.setCursor(shapes.get(handle, self.cursor))
        text = {"value": "pull to scale the amplitude", "time": "pull to scale the time"}.get(handle, "")
        chosen = self.panel.session.view.selection is not None
        self.panel.show_readout(text or ("" if chosen or lane is None else "drag a box over a stretch of a curve"), at)

    def _scale(self, at: QPointF) -> None:
        session = self.panel.session
        if session.view.selection is None:
            return
        start, stop = session.view.selection
        curve = session.document.curve(self._lane)
        if self._held == "value":
            box = self.panel.lane(self._lane).scene_box()
            factor = max(0.0, 1.0 + 2.0 * (self._pressed.y() - at.y()) / max(1.0, box.height()))
            self.ask(self._lane, start, scaled_in_value(curve[start:stop], factor))
            self.panel.show_readout(f"{CURVES[self._lane].title} × {factor:.2f}", at)
        else:
            new_stop = int(np.clip(round(self.panel.frame_at(at)) + 1, start + 2, len(curve)))
            join = JOIN_S * session.document.take.fps
            self.ask(self._lane, *scaled_in_time(curve, start, stop, new_stop, join_frames=join))
            self.panel.show_readout(f"{stop - start} → {counted(new_stop - start, 'frame')}", at)

    def _box(self) -> QRectF:
        session = self.panel.session
        if session.view.selection is None or self._lane not in session.view.lanes:
            return QRectF()
        shown = self.panel.lane(self._lane)
        box = shown.scene_box()
        left, right = shown.x_of(session.view.selection[0] - 0.5), shown.x_of(session.view.selection[1] - 0.5)
        return QRectF(left, box.top() + 4, right - left, box.height() - 8)

    def _handles(self) -> dict[str, QPointF]:
        box = self._box()
        if box.isNull():
            return {}
        return {"value": QPointF(box.center().x(), box.top()), "time": QPointF(box.right(), box.center().y())}

    def _handle_at(self, at: QPointF) -> str:
        here = self.panel.mapToScene(at.toPoint())
        for name, handle in self._handles().items():
            if (handle - here).manhattanLength() <= 2 * HANDLE_PX:
                return name
        return ""

    def _show_box(self) -> None:
        self.panel.show_handles(self._box(), list(self._handles().values()))
