"""What the mouse does in the lanes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QMouseEvent

from app.curves.brush import pulled, reach
from engine.controls import CONTROLS

if TYPE_CHECKING:
    from app.curves.panel import CurvesPanel

NEAR_PX = 14
FINE = 0.25  # with Shift


class Tool(Protocol):
    """A way of working on the curves; positions are in the panel."""

    def press(self, lane: int, event: QMouseEvent) -> None:
        """Begin."""

    def move(self, lane: int | None, event: QMouseEvent) -> None:
        """Go on, or hover where no button is held; `lane` is what lies under the pointer."""

    def release(self, event: QMouseEvent) -> None:
        """Finish: one undo step."""

    def leave(self) -> None:
        """Put hints away."""

    def wheel(self, notches: float) -> None:
        """Change the tool's size."""

    def cancel(self) -> None:
        """Drop what is under way."""


class DragTool:
    """Pull a curve anywhere; a soft brush bends it and the face follows."""

    def __init__(self, panel: CurvesPanel) -> None:
        self._panel = panel
        self._lane: int | None = None
        self._centre, self._from, self._by_mm = 0, QPointF(), 0.0

    def press(self, lane: int, event: QMouseEvent) -> None:
        """Take hold of the curve at the frame under the pointer."""
        session = self._panel.session
        frame = round(self._panel.frame_at(event.position()))
        if not 0 <= frame < len(session.take) or self._panel.inference.busy:
            return
        self._lane, self._centre, self._from, self._by_mm = lane, frame, event.position(), 0.0
        session.move_playhead(frame)
        self._hint(lane, frame, event.position())

    def move(self, lane: int | None, event: QMouseEvent) -> None:
        """Pull by as many millimetres as the pointer has gone up; show where one could pull otherwise."""
        if self._lane is None:
            self._hover(lane, event.position())
            return
        shown = self._panel.lanes[self._lane]
        fine = FINE if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else 1.0
        travelled = shown.value_at(event.position().y()) - shown.value_at(self._from.y())
        self._by_mm += fine * travelled
        self._from = event.position()
        self._ask()
        self._hint(self._lane, self._centre, event.position())

    def release(self, event: QMouseEvent) -> None:
        """Make the drag one undo step."""
        if self._lane is None:
            return
        control = CONTROLS[self._lane]
        if self._by_mm and self._panel.inference.busy:
            self._panel.inference.finish(f"drag {control.title}")
        self._lane = None
        self._panel.show_brush(None, None)
        self._panel.show_readout("", event.position())

    def leave(self) -> None:
        """Put the handle and the read-out away."""
        if self._lane is None:
            self._panel.show_brush(None, None)
            self._panel.show_dot(None)
            self._panel.show_readout("", QPointF())

    def wheel(self, notches: float) -> None:
        """Widen or narrow the brush."""
        session = self._panel.session
        session.set_brush(radius_frames=round(session.radius_frames * 1.15**notches + (notches > 0)))
        if self._lane is not None:
            self._ask()

    def cancel(self) -> None:
        """Let the curve spring back."""
        if self._lane is not None:
            self._lane = None
            self._panel.inference.cancel()
            self._panel.show_brush(None, None)
            self._panel.show_readout("", QPointF())

    def _ask(self) -> None:
        assert self._lane is not None
        session = self._panel.session
        start, stop = reach(self._centre, session.radius_frames, len(session.take))
        asked = session.controls[start:stop].copy()
        asked[:, self._lane] = pulled(
            asked[:, self._lane],
            start,
            self._centre,
            by_mm=self._by_mm,
            radius_frames=session.radius_frames,
            strength=session.strength,
        )
        self._panel.inference.ask(start, asked)

    def _hint(self, lane: int, frame: int, at: QPointF) -> None:
        session, shown = self._panel.session, self._panel.lanes[lane]
        base = float(session.controls[frame, lane])
        asked = max(0.0, base + session.strength * self._by_mm)
        reached = float(session.shown_controls(frame)[lane])
        self._panel.show_brush(shown, reach(frame, session.radius_frames, len(session.take)))
        self._panel.show_dot(shown, frame, reached)
        if self._by_mm:
            self._panel.show_readout(f"asked {asked:.1f}   reached {reached:.1f} mm", at)

    def _hover(self, lane: int | None, at: QPointF) -> None:
        panel, session = self._panel, self._panel.session
        frame = round(panel.frame_at(at))
        if lane is None or not 0 <= frame < len(session.take):
            self.leave()
            panel.unsetCursor()
            return
        shown, value = panel.lanes[lane], float(session.controls[frame, lane])
        panel.setCursor(Qt.CursorShape.SizeVerCursor)
        panel.show_dot(shown, frame, value)
        panel.show_brush(shown, reach(frame, session.radius_frames, len(session.take)))
        control = CONTROLS[lane]
        panel.show_readout(f"{control.title} {value:.1f} {control.unit} · frame {frame} · drag to change", at)
