"""Lines drawn on the picture of a face: what a reviewer means, kept with a note."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF

from app.preview.camera import Camera
from engine.character import Character
from engine.framing import framed
from engine.project import Drawing
from engine.take import Array

PEN, RIM = QColor("#F0A3D0"), QColor("#14161a")
PEN_PX, RIM_PX = 2.5, 4.5
TURNED_DEG = 1.0  # from another side than that a drawing would lie beside what it means
APART = 0.002  # of the head's height; points nearer to the one before are not kept
MOST_POINTS = 20_000  # of one drawing


class Plane:
    """The plane through the middle of a head that faces the camera, on which lines lie.

    Its coordinates are in parts of the head's height, x to the right and y up from the middle: they hold under every
    zoom, pan and size of the picture.

    Parameters
    ----------
    head : whose
    camera : from where it is looked at
    width, height : of the picture in pixels
    """

    def __init__(self, head: Character, camera: Camera, *, width: float, height: float) -> None:
        low, high = framed(head)
        self._pan = np.array(camera.pan)
        shown = camera.shown(low, high, aspect=width / max(1.0, height))
        self._pixels = height / (shown / float((high - low)[1]))  # of a head's height
        self._middle = np.array([width / 2, height / 2])

    def point(self, x: float, y: float) -> tuple[float, float]:
        """Return the place of a pixel."""
        away = (np.array([x, y]) - self._middle) / self._pixels * (1, -1)
        right, up = away + self._pan
        return float(right), float(up)

    def pixels(self, points: Sequence[tuple[float, float]]) -> Array:
        """Return where points are on the picture, (n, 2)."""
        return np.asarray(self._middle + (np.array(points).reshape(-1, 2) - self._pan) * self._pixels * (1, -1))


class Marking:
    """The lines that are being drawn.

    Attributes
    ----------
    on : whether a drag draws
    strokes : what was drawn so far
    """

    def __init__(self) -> None:
        self.on = False
        self.strokes: list[list[tuple[float, float]]] = []
        self._under_way = False

    @property
    def busy(self) -> bool:
        """Whether a line is under way."""
        return self._under_way

    def begin(self, at: tuple[float, float]) -> None:
        """Begin a line."""
        self._under_way = True
        self.strokes.append([at])

    def go_on(self, at: tuple[float, float]) -> None:
        """Draw on to a place."""
        if self._under_way and sum(map(len, self.strokes)) < MOST_POINTS:
            last = self.strokes[-1][-1]
            if abs(at[0] - last[0]) + abs(at[1] - last[1]) >= APART:
                self.strokes[-1].append(at)

    def end(self) -> None:
        """Let go; a press that went nowhere stays as a dot."""
        self._under_way = False

    def drop(self) -> None:
        """Forget what was drawn."""
        self.strokes, self._under_way = [], False

    def taken(self, camera: Camera) -> Drawing | None:
        """Return what was drawn, as it was seen, and forget it; None where nothing was."""
        strokes = tuple(tuple(stroke) for stroke in self.strokes)
        self.drop()
        return Drawing(strokes, numbers_of(camera)) if strokes else None


def numbers_of(camera: Camera) -> tuple[float, ...]:
    """Return a camera as a project keeps it."""
    return (camera.around_deg, camera.above_deg, camera.zoom, *camera.pan, *(camera.frame or ()))


def camera_of(drawing: Drawing) -> Camera | None:
    """Return where a drawing was drawn from; None where it does not say so, or a camera cannot be there."""
    numbers = drawing.camera
    if len(numbers) < 5 or not 0.1 <= numbers[2] <= 100 or not all(0 < value < 100 for value in numbers[5:]):
        return None
    around, above, zoom, right, up, *frame = numbers
    return Camera(around, above, zoom, (right, up), (frame[0], frame[1]) if frame else None)


def seen_alike(drawing: Drawing, camera: Camera) -> bool:
    """Return whether a drawing lies on what it means as the face is looked at now."""
    drawn = camera_of(drawing)
    if drawn is None:
        return True
    around = (drawn.around_deg - camera.around_deg + 180.0) % 360.0 - 180.0
    return abs(around) <= TURNED_DEG and abs(drawn.above_deg - camera.above_deg) <= TURNED_DEG


def draw_strokes(painter: QPainter, plane: Plane, strokes: Iterable[Sequence[tuple[float, float]]]) -> None:
    """Draw lines light on a dark rim, so that they read on skin and on the ground."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    shapes = [QPolygonF([QPointF(*place) for place in plane.pixels(stroke).tolist()]) for stroke in strokes if stroke]
    for colour, wide in ((RIM, RIM_PX), (PEN, PEN_PX)):
        pen = QPen(colour, wide, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap, Qt.PenJoinStyle.RoundJoin)
        painter.setPen(pen)
        for shape in shapes:
            painter.drawPolyline(shape) if shape.count() > 1 else painter.drawPoint(shape.at(0))
