"""A panel without a window: ten pixels to a frame, two to a unit upwards, and it notes what tools ask and show."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt

from app.session import Session
from engine.take import SHAPES, Array, Take

FRAMES = 60
LANE_BOX = QRectF(0, 100, 600, 100)


class Inference:
    """Notes the wishes."""

    def __init__(self) -> None:
        self.busy = False
        self.asked: list[tuple[int, Array]] = []
        self.requests: list[Any] = []
        self.finished: list[str] = []
        self.cancelled = 0

    def ask(self, start: int, asked: Array) -> None:
        self.busy = True
        self.asked.append((start, asked))

    def run(self, request: Any) -> None:
        self.busy = True
        self.requests.append(request)

    def finish(self, title: str) -> None:
        self.busy = False
        self.finished.append(title)

    def cancel(self) -> None:
        self.busy = False
        self.cancelled += 1


class Panel:
    """What tools need of the panel of curves."""

    def __init__(self) -> None:
        rng = np.random.default_rng(5)
        weights = np.clip(0.3 + np.cumsum(rng.normal(0, 0.01, (FRAMES, len(SHAPES))), axis=0), 0, 1)
        self.session = Session(Take(weights, 30.0))
        self.inference = Inference()
        self.readouts: list[str] = []
        self.handles: list[tuple[QRectF, list[QPointF]]] = []
        self.cursors: list[Qt.CursorShape] = []

    def frame_at(self, at: QPointF) -> float:
        return at.x() / 10

    def mapToScene(self, at: Any) -> QPointF:
        return QPointF(at)

    def lane(self, _: int) -> SimpleNamespace:
        return SimpleNamespace(
            value_at=lambda y: (200 - y) / 2, scene_box=lambda: QRectF(LANE_BOX), x_of=lambda frame: 10 * frame
        )

    def show_readout(self, text: str, _: QPointF) -> None:
        self.readouts.append(text)

    def show_handles(self, box: QRectF, handles: list[QPointF]) -> None:
        self.handles.append((box, handles))

    def setCursor(self, shape: Qt.CursorShape) -> None:
        self.cursors.append(shape)

    def show_brush(self, *_: object) -> None:
        pass

    def show_dot(self, *_: object) -> None:
        pass


def event(x: float, y: float = 150.0) -> Any:
    """A mouse event at a place of the panel."""
    return SimpleNamespace(position=lambda: QPointF(x, y), modifiers=lambda: Qt.KeyboardModifier.NoModifier)
