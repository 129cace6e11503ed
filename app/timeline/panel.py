"""The ruler and the lanes of sound, visemes, spans, flags and marks above the curves, and the scroll bar beneath."""

from __future__ import annotations

from PySide6.QtCore import QPoint, QPointF, QRectF, QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QContextMenuEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QWheelEvent,
)
from PySide6.QtWidgets import QScrollBar, QSizePolicy, QWidget

from app.session import Change, Session
from app.theme import GRID, Palette
from app.timeline.flags import FLAGS_PX, FlagLane
from app.timeline.marks import LANE_PX, NEAR_PX, draw_marks, draw_ranges, lanes, nearest_mark
from app.timeline.spans import SpanLane
from app.timeline.viseme_editing import VisemeEditing
from app.timeline.visemes import VISEMES_PX, Place
from app.timeline.waveform import draw_waveform
from app.widgets.text import tip
from engine.project import Note, Pin
from engine.take import timecode

RULER_PX, AUDIO_PX, SPANS_PX, LABEL_PX = 26, 35, 22, 84
SCROLL_PX = 10  # the lanes' scroll bar, which is always there so that frames stay under their ticks
SLACK_PX = 3  # a press that moves no farther is a click
STEPS_FRAMES = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000)
LAYOUT = (
    Change.TAKE | Change.MEDIA | Change.MARKS | Change.VISEMES | Change.REVIEW
)  # what may bring lanes or take them away
SHOWN = LAYOUT | Change.CURVES | Change.FLAGS | Change.VIEW | Change.PLAYHEAD | Change.SELECTION
STEPS_S = (0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600)
HINTS = {
    "": "Hours, minutes, seconds and frames. Drag to scrub, Shift-drag selects, the wheel zooms.",
    "audio": "Drag to move the sound against the face.",
    "spans": "Drag to mark a span, click one to choose it.",
    "visemes": "Drag the ends of a block, double-click to select it, right-click to change it.",
    "changes": "Where the take differs from the recording: Alt+Up and Alt+Down go from one to the next.",
    "flags": "What to look at: click a mark to go there, or Up and Down from one to the next.",
}


class Timeline(QWidget):
    """Timecode to scrub on, and beneath it a lane for each kind of thing that lies in time.

    Parameters
    ----------
    session : whose time is shown
    gutter_px : width of the lanes' gutter, so that frames stand under their ticks

    Attributes
    ----------
    visemes : the lane of what is said, under the hand
    """

    marked = Signal()  # the selection was drawn in the lane: it is to become a span
    told = Signal(str)  # what is wrong at the flag that was clicked
    slid = Signal()  # the sound was dragged to where it is shown
    menu_wanted = Signal(str, QPoint, str)  # kind of thing, where on the screen, what to say of it

    def __init__(self, session: Session, colours: Palette, *, gutter_px: int) -> None:
        super().__init__()
        self._session, self._colours, self._gutter = session, colours, gutter_px
        self._selecting: int | None = None
        self._marking = self._scrubbing = False
        self._sliding: tuple[float, float] | None = None  # where the sound was taken hold of, and its beginning then
        self.in_frames = False
        self._flags, self._spans = FlagLane(), SpanLane()
        self.visemes = VisemeEditing(session, self, self._viseme_place)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setMouseTracking(True)
        self.setAccessibleName("Timeline")
        session.changed.connect(self._on_change)

    def paint_with(self, colours: Palette) -> None:
        """Take on a theme's colours."""
        self._colours = colours
        self.update()

    def count_in_frames(self, on: bool) -> None:
        """Count in frames on the ruler, or in timecode."""
        self.in_frames = on
        self.update()

    def sizeHint(self) -> QSize:
        """As high as its lanes."""
        return QSize(400, round(max(box.bottom() for box in self._lanes().values())))

    def _on_change(self, change: Change) -> None:
        if change & LAYOUT:
            self.updateGeometry()
        if change & SHOWN:
            self.update()

    # --- geometry

    def _lanes(self) -> dict[str, QRectF]:
        """Return the lanes that are there, from top to bottom, each with its box right of the gutter."""
        session = self._session
        heights = {"audio": AUDIO_PX} if session.document.audio is not None else {}
        if session.document.visemes is not None:
            heights["visemes"] = VISEMES_PX
        heights |= {"spans": SPANS_PX, "flags": FLAGS_PX}
        if session.document.differences is not None:
            heights["changes"] = LANE_PX
        heights |= dict.fromkeys(lanes(session.document.marks), LANE_PX)
        boxes, top = {}, float(RULER_PX)
        for name, height in heights.items():
            boxes[name] = QRectF(self._gutter, top, self._span_px(), height)
            top += height
        return boxes

    def lane_box(self, name: str) -> QRectF:
        """Return where a lane is; an empty box for one that is not there."""
        return self._lanes().get(name, QRectF())

    def _lane_at(self, y: float) -> str:
        return next((name for name, box in self._lanes().items() if box.top() < y <= box.bottom()), "")

    def _viseme_place(self) -> Place:
        first, last = self._session.view.range
        fps = self._session.document.take.fps
        return self.lane_box("visemes").adjusted(0, 3, 0, -3), (first / fps, last / fps)

    def _near(self, lane: str, x: float) -> Note | Pin | None:
        """Return the pin or note of a lane at a place in the widget."""
        within = self.frame_at(x + NEAR_PX) - self.frame_at(x)
        return nearest_mark(self._session.document.marks, lane, self.frame_at(x), within)

    def _span_px(self) -> float:
        return max(1.0, self.width() - self._gutter - GRID - SCROLL_PX)

    def x_of(self, frame: float) -> float:
        """Return the position of a frame in the widget."""
        first, last = self._session.view.range
        return self._gutter + (frame - first) / max(1e-9, last - first) * self._span_px()

    def frame_at(self, x: float) -> float:
        """Return the fractional frame at a position in the widget."""
        first, last = self._session.view.range
        return first + (x - self._gutter) / self._span_px() * (last - first)

    # --- drawing

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the ruler, every lane, the selection and the playhead."""
        painter, boxes = QPainter(self), self._lanes()
        painter.setPen(QColor(self._colours.quiet))
        left = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
        unit = "frame" if self.in_frames else "h : min : s : frame"
        painter.drawText(QRectF(GRID, 4, self._gutter, 14), left, unit)
        for name, box in boxes.items():
            painter.drawText(QRectF(GRID, box.top(), self._gutter, box.height()), left, name)
        painter.setClipRect(QRectF(self._gutter, 0, self._span_px(), self.height()))
        self._draw_selection(painter)
        self._draw_ticks(painter)
        self._draw_audio(painter)
        self.visemes.draw(painter, self._colours)
        marks, view = self._session.document.marks, self._session.view.range
        self._spans.draw(painter, self._session.document.open_spans, boxes["spans"], view, self._colours)
        self._flags.draw(painter, self._session.document.flags, boxes["flags"], view, self._colours)
        draw_ranges(painter, self._session.document.differences or (), (self.lane_box("changes"), view), self._colours)
        for name in lanes(marks):
            draw_marks(painter, marks, name, (boxes[name], view), self._colours)
        x = self.x_of(self._session.view.playhead)
        painter.setPen(QPen(QColor(self._colours.text), 1))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)  # as in the lanes, or the two halves part by a pixel
        painter.drawLine(QPointF(x, 2.0), QPointF(x, self.height()))
        painter.setBrush(QColor(self._colours.text))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.drawPolygon([QPointF(x - 5, 0), QPointF(x + 5, 0), QPointF(x, 7)])

    def _draw_selection(self, painter: QPainter) -> None:
        chosen = self._session.view.selection
        if chosen is None:
            return
        left, right = self.x_of(chosen[0] - 0.5), self.x_of(chosen[1] - 0.5)
        tint = QColor(self._colours.accent)
        tint.setAlphaF(0.25)
        painter.fillRect(QRectF(left, 0, right - left, RULER_PX), tint)

    def _draw_ticks(self, painter: QPainter) -> None:
        session = self._session
        fps = session.document.take.fps
        first, last = session.view.range
        per_second = self._span_px() / max(1e-9, (last - first) / fps)
        steps_s = [frames / fps for frames in STEPS_FRAMES] if self.in_frames else STEPS_S
        step = next((s for s in steps_s if s * per_second >= LABEL_PX), steps_s[-1])
        index = int(first / fps / step)
        middle = Qt.AlignmentFlag.AlignCenter
        while index * step * fps <= last:
            time_s = index * step
            x = self.x_of(time_s * fps)
            painter.setPen(QColor(self._colours.quiet))
            shown = f"{round(time_s * fps):,}" if self.in_frames else timecode(time_s, fps)
            half = painter.fontMetrics().horizontalAdvance(shown) / 2
            if self._gutter <= x - half and x + half <= self._gutter + self._span_px():  # none is cut
                painter.drawText(QRectF(x - 50, 4, 100, 14), middle, shown)
            painter.setPen(QColor(self._colours.edge))
            painter.drawLine(int(x), 20, int(x), RULER_PX)
            index += 1

    def _draw_audio(self, painter: QPainter) -> None:
        session = self._session
        if session.document.audio is not None:
            first_s, last_s = (
                frame / session.document.take.fps - session.document.offset_s("audio") for frame in session.view.range
            )
            box = QRectF(self._gutter, RULER_PX + 2, self._span_px(), AUDIO_PX - 4)
            draw_waveform(painter, session.document.audio, box, (first_s, last_s), self._colours.quiet)

    # --- the mouse

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Scrub on the ruler; in a lane take hold of what is there, or begin to mark a span; with Shift select."""
        if event.button() != Qt.MouseButton.LeftButton:
            return
        x, lane = event.position().x(), self._lane_at(event.position().y())
        frame = round(self.frame_at(x))
        if lane == "spans" and (
            hit := [span for span in self._session.document.marks.spans if span.start <= frame < span.stop]
        ):
            self._session.view.select((hit[0].start, hit[0].stop))
            self._session.view.move_playhead(hit[0].start)
        elif lane == "flags" and (mark := self._flags.at(x)) is not None:
            self._session.view.move_playhead(mark.flag.start)
            self.told.emit(mark.sentence)
        elif (near := self._near(lane, x)) is not None:
            self._session.view.move_playhead(near.frame)
        elif lane == "spans" or event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
            self._selecting, self._marking = frame, lane == "spans"
        elif lane == "audio":
            self._sliding = event.position().x(), self._session.document.offset_s("audio")
        elif lane != "visemes" or not self.visemes.take(x):
            self._scrubbing = True
            self._session.view.move_playhead(frame)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Go on with what the press began; show by the pointer what a press would take hold of."""
        frame = round(self.frame_at(event.position().x()))
        if self.visemes.dragging:
            self.visemes.move(event.position().x())
        elif self._selecting is not None:
            first, last = sorted((self._selecting, frame))
            self._session.view.select((first, last + 1))
        elif self._scrubbing:
            self._session.view.move_playhead(frame)
        elif self._sliding is not None:
            self._slide(event.position().x())
        else:
            self._show_pointer(event.position())

    def _slide(self, x: float) -> None:
        """Take the sound along with the mouse; back where it began it is left as it was."""
        assert self._sliding is not None
        began, offset_s = self._sliding
        if self._session.document.sliding is not None or abs(x - began) > SLACK_PX:
            self._session.document.slide(
                "audio", offset_s + (self.frame_at(x) - self.frame_at(began)) / self._session.document.take.fps
            )

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End the selection, or make it a span; a mere click clears it."""
        if self.visemes.dragging:
            self.visemes.release()
        frame, selecting = round(self.frame_at(event.position().x())), self._selecting
        self._selecting, self._scrubbing = None, False
        held, self._sliding = self._sliding, None
        if held is not None and self._session.document.sliding is None:
            self._session.view.move_playhead(frame)
        elif held is not None:
            self.slid.emit()
        if selecting is None:
            return
        if frame == selecting:
            self._session.view.select(None)
            self._session.view.move_playhead(frame)
        elif self._marking:
            self.marked.emit()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Select the frames of a viseme."""
        if self._lane_at(event.position().y()) == "visemes":
            self.visemes.drop()
            self.visemes.select(event.position().x())

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Offer what can be done with what lies under the pointer, and go there: the menu's actions work on it."""
        lane, x = self._lane_at(event.y()), event.x()
        if lane == "visemes":
            self.visemes.open_menu(x, event.globalPos(), self._colours)
            return
        frame = round(self.frame_at(x))
        span = next((each for each in self._session.document.marks.spans if each.start <= frame < each.stop), None)
        mark = self._flags.at(x) if lane == "flags" else None
        near = self._near(lane, x)
        kind, told = ("audio", "") if lane == "audio" else ("time", "")
        if lane == "spans" and span is not None:
            self._session.view.select((span.start, span.stop))
            kind, frame = "span", span.start
        elif mark is not None:
            kind, frame, told = "flag", mark.flag.start, mark.flag.sentence
        elif near is not None:
            kind, frame, told = lane.removesuffix("s"), near.frame, near.text if isinstance(near, Note) else ""
        self._session.view.move_playhead(frame)
        self.menu_wanted.emit(kind, event.globalPos(), told)

    def told_at(self, place: QPointF) -> str:
        """Return what to tell of a place in the widget."""
        lane = self._lane_at(place.y())
        mark = self._flags.at(place.x()) if lane == "flags" else None
        near = self._near(lane, place.x())
        if mark is not None:
            return mark.sentence
        if isinstance(near, Note):
            return f"{near.text}\n{near.author}, {near.time}"
        said = self.visemes.tell(place.x()) if lane == "visemes" and place.x() >= self._gutter else ""
        return said or HINTS.get(lane, HINTS[""])

    def _show_pointer(self, place: QPointF) -> None:
        self.setToolTip(tip(self.told_at(place)))
        lane = self._lane_at(place.y())
        if lane == "visemes" and self.visemes.edge_at(place.x()) is not None:
            self.setCursor(Qt.CursorShape.SplitHCursor)
        elif lane == "audio":
            self.setCursor(Qt.CursorShape.SizeHorCursor)
        elif lane == "flags" and self._flags.at(place.x()) is not None:
            self.setCursor(Qt.CursorShape.PointingHandCursor)
        else:
            self.unsetCursor()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom around the pointer; with Shift or sideways pan."""
        turn = event.angleDelta()
        notches = (turn.y() or turn.x()) / 120.0
        if event.modifiers() & Qt.KeyboardModifier.ShiftModifier or abs(turn.x()) > abs(turn.y()):
            first, last = self._session.view.range
            shift = -notches * 0.1 * (last - first)
            self._session.view.set_range(first + shift, last + shift)
        else:
            self._session.view.zoom(1.2**notches, self.frame_at(event.position().x()))


class TimeScroll(QScrollBar):
    """Where in the take the view is, in frames."""

    def __init__(self, session: Session) -> None:
        super().__init__(Qt.Orientation.Horizontal)
        self._session = session
        self.valueChanged.connect(self._scrolled)
        session.changed.connect(self._on_change)
        self._on_change(Change.VIEW)

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.VIEW):
            first, last = self._session.view.range
            with QSignalBlocker(self):
                self.setRange(0, max(0, len(self._session.document.take) - 1 - int(last - first)))
                self.setPageStep(max(1, int(last - first)))
                self.setSingleStep(max(1, int((last - first) / 20)))
                self.setValue(int(first))

    def _scrolled(self, value: int) -> None:
        first, last = self._session.view.range
        self._session.view.set_range(value, value + last - first)
