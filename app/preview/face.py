"""The picture of the face: what is drawn over it, and how the mouse turns, moves and zooms the camera."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QPoint, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QContextMenuEvent,
    QImage,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.preview.camera import Camera
from app.preview.marking import Marking, Plane, draw_strokes, seen_alike
from app.preview.overlay import Overlay, draw_scale
from app.preview.renderer import GROUND, Picture
from app.preview.wipe import Wipe
from app.theme import GRID
from engine.character import Character, bundled
from engine.project import Drawing

ROUNDED_PX = 4  # a picture of half the resolution is no more than this narrower or wider
CLICK_PX = 4  # a press that moves no further is a click


class Face(QWidget):
    """The picture; drag orbits, right-drag or Shift-drag pans, wheel zooms, double-click frames the head."""

    camera_moved = Signal(object)
    clicked = Signal(QPointF)
    menu_wanted = Signal(QPoint)  # on the screen
    resized = Signal()  # a picture of another size is wanted

    def __init__(self) -> None:
        super().__init__()
        self.camera = Camera()
        self.image = QImage()
        self.view = self.pictured = "After"  # what is chosen, and what the picture shows by now
        self.message = "Preparing the preview…"
        self.overlay: Overlay | None = None
        self.wipe, self.marking = Wipe(), Marking()
        self.noted: tuple[Drawing, ...] = ()  # of the notes at the playhead
        self.head: Character | None = None  # that is shown; None is the bundled one
        self._grip: QPointF | None = None
        self._pressed_at = QPointF()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(200, 200)
        self.setCursor(Qt.CursorShape.OpenHandCursor)
        self.setAccessibleName("Face preview")

    def sizeHint(self) -> QSize:
        """Prefer a portrait."""
        return QSize(460, 620)

    def show_picture(self, picture: Picture, overlay: Overlay | None = None, view: str = "") -> None:
        """Show a picture, (height, width, 3) uint8, of one of the views, and what is drawn over it."""
        self.overlay, self.pictured = overlay, view or self.view
        height, width = picture.shape[:2]
        self.image = QImage(picture.data, width, height, 3 * width, QImage.Format.Format_RGB888).copy()
        self.message = ""
        self.repaint()

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the picture, then what labels it."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(*GROUND))
        if not self.image.isNull():
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
            if self.pictured == "Wipe":
                self.wipe.draw(painter, self.image, self.picture_box())
            else:
                painter.drawImage(self.picture_box(), self.image)
        painter.setPen(QColor("#e3e6eb"))
        if self.message:
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(self.rect().adjusted(24, 24, -24, -24), flags, self.message)
        elif self.overlay is not None:
            self.overlay.draw(painter)
        elif self.pictured == "Split":
            middle = self.width() // 2
            painter.drawLine(middle, 0, middle, self.height())
            painter.drawText(GRID, 18, "before")
            painter.drawText(middle + GRID, 18, "after")
        elif self.pictured == "Difference":
            draw_scale(painter, self.height())
        elif self.pictured == "Wipe":
            self.wipe.draw_line(painter, self.picture_box())
        if self.overlay is None and self.pictured != "Split" and not self.message:
            self._draw_marks(painter)

    def _draw_marks(self, painter: QPainter) -> None:
        """Draw the lines of the notes at the playhead, and those under way."""
        strokes = [stroke for each in self.noted if seen_alike(each, self.camera) for stroke in each.strokes]
        if strokes or self.marking.strokes:
            draw_strokes(painter, self._plane(), [*strokes, *self.marking.strokes])

    def _plane(self) -> Plane:
        return Plane(self.head or bundled(), self.camera, width=self.width(), height=self.height())

    def draw_on(self, on: bool) -> None:
        """Let a drag draw on the picture, or turn the face again and forget what was drawn."""
        self.marking.on = on
        self.marking.drop()
        self._show_pointer(QPointF(-1.0, 0.0))
        self.update()

    def picture_box(self) -> QRectF:
        """Return where the picture is: everywhere; one of another format in its own, until the next one comes."""
        pictures = 2 if self.pictured == "Wipe" else 1
        width = self.image.width() / pictures * self.height() / max(1, self.image.height())
        if abs(width - self.width()) <= ROUNDED_PX:
            return QRectF(self.rect())
        return QRectF((self.width() - width) / 2, 0.0, width, self.height())

    def event(self, event: QEvent) -> bool:
        """Ask for another picture on a screen of another resolution."""
        if event.type() == QEvent.Type.DevicePixelRatioChange:
            self.resized.emit()
        return super().event(event)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Ask for a picture of the new size."""
        super().resizeEvent(event)
        self.resized.emit()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take hold of the camera, or of the line between before and after; or begin to draw."""
        self._grip = self._pressed_at = event.position()
        x, left = event.position().x(), event.button() == Qt.MouseButton.LeftButton
        if left and self.pictured == "Wipe" and self.wipe.is_at(x, self.width()):
            self.wipe.held = True
        elif left and self.marking.on:
            self.marking.begin(self._plane().point(x, event.position().y()))
            self.update()
        else:
            self.setCursor(Qt.CursorShape.ClosedHandCursor)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Orbit or pan; move the line, or draw."""
        at = event.position()
        if self.wipe.held:
            self.wipe.move_to(at.x(), self.width())
            self.update()
            return
        if self.marking.busy:
            self.marking.go_on(self._plane().point(at.x(), at.y()))
            self.update()
            return
        if self._grip is None:
            self._show_pointer(at)
        if self._grip is None or (event.position() - self._pressed_at).manhattanLength() <= CLICK_PX:
            return
        moved = event.position() - self._grip
        self._grip = event.position()
        if event.buttons() & Qt.MouseButton.RightButton or event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
            scale = 1.0 / (self.height() * self.camera.zoom)
            self._move(self.camera.panned(-moved.x() * scale, moved.y() * scale))
        else:
            self._move(self.camera.orbited(around_deg=-0.4 * moved.x(), above_deg=0.4 * moved.y()))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Let go; a press that went nowhere is a click."""
        self._grip = None
        if self.wipe.held or self.marking.busy:
            self.wipe.held = False
            self.marking.end()
            self._show_pointer(event.position())
            return
        clicked = (event.position() - self._pressed_at).manhattanLength() <= CLICK_PX
        if clicked and event.button() == Qt.MouseButton.RightButton:
            self.menu_wanted.emit(event.globalPosition().toPoint())
        elif clicked:
            self.clicked.emit(event.position())
        self._show_pointer(event.position())

    def _show_pointer(self, at: QPointF) -> None:
        """Show by the pointer what a press would do."""
        shape = Qt.CursorShape.CrossCursor if self.marking.on else Qt.CursorShape.OpenHandCursor
        on_line = self.pictured == "Wipe" and self.wipe.is_at(at.x(), self.width())
        self.setCursor(Qt.CursorShape.SplitHCursor if on_line else shape)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Frame the whole head from the front."""
        self.frame_head()

    def frame_head(self) -> None:
        """Look at the whole head from the front."""
        self._move(Camera())

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Offer what can be done with the face; the mouse's own way is a right click, since a right drag pans."""
        event.accept()
        if event.reason() == QContextMenuEvent.Reason.Keyboard:
            self.menu_wanted.emit(self.mapToGlobal(self.rect().center()))

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom."""
        self._move(self.camera.zoomed(1.15 ** (event.angleDelta().y() / 120.0)))

    def _move(self, camera: Camera) -> None:
        self.camera = camera
        self.camera_moved.emit(camera)
