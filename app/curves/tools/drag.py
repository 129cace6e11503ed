"""The Drag tool: pulls a curve through a soft brush."""

from __future__ import annotations

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QMouseEvent

from app.curves.brush import pulled, reach
from app.curves.tools.base import FINE, Stroke
from app.session.curve_table import CURVES

WHEEL_STEP = 1.15  # the radius grows by a notch


class DragTool(Stroke):
    """Pulls a curve anywhere through a soft brush; the face follows."""

    cursor = Qt.CursorShape.SizeVerCursor
    verb = "drag"
    _centre = 0
    _from = QPointF()
    _by = 0.0

    def press(self, lane: int, event: QMouseEvent) -> None:
        """Begin to drag the curve at the frame under the pointer."""
        session = self.panel.session
        frame = round(self.panel.frame_at(event.position()))
        if (
            not 0 <= frame < len(session.document.take)
            or self.panel.inference.busy
            or session.document.draft is not None
        ):
            return
        self._lane, self._centre, self._from, self._by = lane, frame, event.position(), 0.0
        session.view.move_playhead(frame)
        self._hint(lane, frame, event.position())

    def move(self, lane: int | None, event: QMouseEvent) -> None:
        """Pull by as much as the pointer has gone up; show where one could pull otherwise."""
        if self._lane is None:
            self._hover(lane, event.position())
            return
        shown = self.panel.lane(self._lane)
        fine = FINE if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else 1.0
        self._by += fine * (shown.value_at(event.position().y()) - shown.value_at(self._from.y()))
        self._from = event.position()
        self._pull()
        self._hint(self._lane, self._centre, event.position())

    def wheel(self, notches: float) -> None:
        """Widen or narrow the brush."""
        session = self.panel.session
        session.view.set_brush(radius_s=session.view.radius_s * WHEEL_STEP**notches)
        if self._lane is not None:
            self._pull()

    def refresh(self) -> None:
        """Let handle and read-out follow the face, which answers a moment after the pointer."""
        if self._lane is not None and self.panel.session.document.draft is not None:
            self._hint(self._lane, self._centre, self._from)

    def _pull(self) -> None:
        if self._lane is None or not self._by:
            return
        session = self.panel.session
        start, stop = reach(self._centre, session.view.radius_frames, len(session.document.take))
        curve = session.document.curve(self._lane)[start:stop]
        kind, radius, strength = CURVES[self._lane], session.view.radius_frames, session.view.strength
        limits = {"floor": kind.lowest, "ceiling": kind.highest}
        self.ask(
            self._lane,
            start,
            pulled(curve, start, self._centre, by=self._by, radius_frames=radius, strength=strength, **limits),
        )

    def _hint(self, lane: int, frame: int, at: QPointF) -> None:
        session, shown, curve = self.panel.session, self.panel.lane(lane), CURVES[lane]
        asked = float(session.document.curve(lane)[frame]) + session.view.strength * self._by
        asked = min(max(asked, curve.lowest), curve.highest)
        reached = session.document.value(lane, frame)
        self.panel.show_brush(shown, reach(frame, session.view.radius_frames, len(session.document.take)))
        self.panel.show_dot(shown, frame, reached)
        if self._by:
            self.panel.show_readout(f"asked {curve.shown(asked)}   reached {curve.shown(reached)}", at)

    def _hover(self, lane: int | None, at: QPointF) -> None:
        session = self.panel.session
        frame = round(self.panel.frame_at(at))
        if lane is None or not 0 <= frame < len(session.document.take):
            self.leave()
            return
        shown, curve, value = self.panel.lane(lane), CURVES[lane], session.document.value(lane, frame)
        self.panel.show_dot(shown, frame, value)
        self.panel.show_brush(shown, reach(frame, session.view.radius_frames, len(session.document.take)))
        self.panel.show_readout(f"{curve.title} {curve.shown(value)} · frame {frame} · drag to change", at)
