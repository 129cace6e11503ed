"""Draw: sketch the curve over a range."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QMouseEvent

from app.curves.brush import eased_to
from app.curves.tools.base import Stroke
from app.session.curve_table import CURVES
from engine.take import Array

JOIN_S = 0.12  # over which a sketch eases into what lies beside it


class DrawTool(Stroke):
    """Sketch the curve as it should be; what lies beside the sketch stays."""

    cursor = Qt.CursorShape.CrossCursor
    verb = "draw"

    def __init__(self, panel) -> None:  # type: ignore[no-untyped-def]
        super().__init__(panel)
        self._sketch: dict[int, float] = {}
        self._last = (0, 0.0)

    def press(self, lane: int, event: QMouseEvent) -> None:
        """Put the pen down."""
        if self.panel.inference.busy:
            return
        self._lane, self._sketch = lane, {}
        self._last = self._point(lane, event.position())
        self._sketch[self._last[0]] = self._last[1]

    def move(self, lane: int | None, event: QMouseEvent) -> None:
        """Draw on; frames that the pointer jumped over lie on a line."""
        at = event.position()
        if self._lane is None:
            if lane is None:
                self.leave()
            else:
                frame, value = self._point(lane, at)
                self.panel.show_readout(f"{CURVES[lane].shown(value)} · frame {frame} · draw the curve", at)
            return
        frame, value = self._point(self._lane, at)
        last_frame, last_value = self._last
        low, high = sorted((last_frame, frame))
        line = np.interp(np.arange(low, high + 1), *_ascending((last_frame, frame), (last_value, value)))
        self._sketch.update(zip(range(low, high + 1), map(float, line), strict=True))
        self._last = (frame, value)
        self.panel.session.view.move_playhead(frame)
        self.ask(self._lane, *self._asked(self._lane))
        self.panel.show_readout(f"{CURVES[self._lane].shown(value)} · frame {frame}", at)

    def _point(self, lane: int, at: QPointF) -> tuple[int, float]:
        frame = int(np.clip(round(self.panel.frame_at(at)), 0, len(self.panel.session.document.take) - 1))
        return frame, max(CURVES[lane].lowest, self.panel.lane(lane).value_at(self.panel.mapToScene(at.toPoint()).y()))

    def _asked(self, lane: int) -> tuple[int, Array]:
        """Return the sketch, with a few frames at either side that lead into it."""
        frames = sorted(self._sketch)
        session, values = self.panel.session, np.array([self._sketch[frame] for frame in frames])
        ease = JOIN_S * session.document.take.fps
        span = frames[0], frames[-1] + 1
        return eased_to(session.document.curve(lane), span, values, before_frames=ease, after_frames=ease)


def _ascending(frames: tuple[int, int], values: tuple[float, float]) -> tuple[tuple[int, int], tuple[float, float]]:
    if frames[0] <= frames[1]:
        return frames, values
    return (frames[1], frames[0]), (values[1], values[0])
