"""Mark: drag over frames to make them a span."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import Qt
from PySide6.QtGui import QMouseEvent

from app.curves.tools.base import Tool
from app.session.commands import MarkCommand
from engine.project import Span
from engine.words import counted


class MarkTool(Tool):
    """Drag over the frames that need work; they become a span."""

    cursor = Qt.CursorShape.IBeamCursor
    _from: int | None = None

    @property
    def busy(self) -> bool:
        """Whether a span is being drawn."""
        return self._from is not None

    def press(self, lane: int, event: QMouseEvent) -> None:
        """Begin at the frame under the pointer."""
        self._from = round(self.panel.frame_at(event.position()))

    def move(self, lane: int | None, event: QMouseEvent) -> None:
        """Widen the span."""
        frame, at = round(self.panel.frame_at(event.position())), event.position()
        if self._from is None:
            self.panel.show_readout("drag over frames to mark them" if lane is not None else "", at)
            return
        first, last = sorted((self._from, frame))
        self.panel.session.view.select((first, last + 1))
        self.panel.show_readout(counted(last + 1 - first, "frame"), at)

    def release(self, event: QMouseEvent) -> None:
        """Make it a span, one undo step; a mere click moves the playhead."""
        if self._from is None:
            return
        session, start = self.panel.session, self._from
        self._from = None
        self.panel.show_readout("", event.position())
        if round(self.panel.frame_at(event.position())) == start or session.view.selection is None:
            session.view.move_playhead(start)
            return
        span = Span(*session.view.selection)
        if span not in session.document.marks.spans:
            spans = tuple(sorted((*session.document.marks.spans, span), key=lambda each: each.start))
            session.document.undo.push(
                MarkCommand.of(session.document, replace(session.document.marks, spans=spans), "mark a span")
            )

    def cancel(self) -> None:
        """Mark nothing."""
        self._from = None
        self.panel.session.view.select(None)


class ScrubTool(Tool):
    """Move the playhead; for tools whose settings are in the inspector."""

    cursor = Qt.CursorShape.ArrowCursor
    _held = False

    @property
    def busy(self) -> bool:
        """Whether the playhead is held."""
        return self._held

    def press(self, lane: int, event: QMouseEvent) -> None:
        """Go to the frame under the pointer."""
        self._held = True
        self.panel.session.view.move_playhead(round(self.panel.frame_at(event.position())))

    def move(self, lane: int | None, event: QMouseEvent) -> None:
        """Follow the pointer."""
        if self._held:
            self.panel.session.view.move_playhead(round(self.panel.frame_at(event.position())))

    def release(self, event: QMouseEvent) -> None:
        """Cancel the gesture."""
        self._held = False

    def cancel(self) -> None:
        """Cancel the gesture."""
        self._held = False
