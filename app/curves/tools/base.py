"""What every tool can do, and what most of them share."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QMouseEvent

from app.session.curve_table import CURVES
from engine.editing import WeightRequest
from engine.take import SHAPES, Array

if TYPE_CHECKING:
    from app.curves.panel import CurvesPanel

FINE = 0.25  # with Shift, the pointer counts this much


class Tool:
    """A way of working on the curves; lanes are indices into CURVES, positions are in the panel."""

    cursor = Qt.CursorShape.ArrowCursor

    def __init__(self, panel: CurvesPanel) -> None:
        self.panel = panel

    @property
    def busy(self) -> bool:
        """Whether a gesture has begun and not ended."""
        return False

    def press(self, lane: int, event: QMouseEvent) -> None:
        """Begin."""

    def move(self, lane: int | None, event: QMouseEvent) -> None:
        """Go on, or hover where nothing was begun; `lane` is what lies under the pointer."""

    def release(self, event: QMouseEvent) -> None:
        """Finish: one undo step."""

    def leave(self) -> None:
        """Put hints away."""
        if not self.busy:
            self.panel.show_brush(None, None)
            self.panel.show_dot(None)
            self.panel.show_readout("", QPointF())

    def placed(self) -> None:
        """Follow lanes that are at other places, or show other frames."""

    def wheel(self, notches: float) -> None:
        """Change the tool's size."""

    def cancel(self) -> None:
        """Cancel the gesture."""

    def refresh(self) -> None:
        """Show the result that has come in."""

    def ask(self, lane: int, start: int, curve: Array) -> None:
        """Ask for a curve, (n,), in one lane from frame `start`: of a control through the networks, of a weight as it is."""
        session = self.panel.session
        column = CURVES[lane].column
        if CURVES[lane].is_weight:
            self.panel.inference.run(WeightRequest(SHAPES[column], start, curve))
            return
        asked = session.document.controls[start : start + len(curve)].copy()
        asked[:, column] = curve.clip(min=CURVES[lane].lowest)
        self.panel.inference.ask(start, asked)

    def done(self, verb: str, lane: int, at: QPointF) -> None:
        """Make what was asked one undo step, named after the verb and the curve."""
        if self.panel.inference.busy:
            self.panel.inference.finish(f"{verb} {CURVES[lane].title}")
        self.panel.show_brush(None, None)
        self.panel.show_readout("", at)


class Stroke(Tool):
    """A tool that holds one curve from the press to the release."""

    _lane: int | None = None
    verb = ""  # what the undo step is called

    @property
    def busy(self) -> bool:
        """Whether a curve is held."""
        return self._lane is not None

    def release(self, event: QMouseEvent) -> None:
        """Make it one undo step; a click that asked for nothing is none."""
        if self._lane is not None:
            lane, self._lane = self._lane, None
            self.done(self.verb, lane, event.position())

    def cancel(self) -> None:
        """Cancel the gesture; the curve returns to what it was."""
        if self._lane is not None:
            self._lane = None
            self.panel.inference.cancel()
            self.leave()
