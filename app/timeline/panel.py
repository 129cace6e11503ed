"""The ruler and the lanes of sound, visemes, spans, flags and marks above the curves."""

from __future__ import annotations

from PySide6.QtCore import QPoint, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QContextMenuEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QWheelEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.session import Change, Session
from app.theme import GRID, Palette
from app.timeline.flags import FLAGS_PX, FlagLane
from app.timeline.hits import Grip, Hit, Layout, hit
from app.timeline.marks import LANE_PX, draw_marks, draw_ranges, lanes
from app.timeline.ruler import draw_ticks
from app.timeline.spans import SpanLane
from app.timeline.viseme_editing import VisemeEditing
from app.timeline.visemes import VISEMES_PX, Place
from app.timeline.waveform import draw_waveform
from app.widgets.text import tip
from engine.project import Note

RULER_PX, AUDIO_PX, SPANS_PX = 26, 35, 22
SCROLL_PX = 10  # the lanes' scroll bar, which is always there so that frames stay under their ticks
SLACK_PX = 3  # a press that moves no farther is a click
LAYOUT = (
    Change.TAKE | Change.MEDIA | Change.MARKS | Change.VISEMES | Change.REVIEW
)  # what may bring lanes or take them away
SHOWN = LAYOUT | Change.CURVES | Change.FLAGS | Change.VIEW | Change.PLAYHEAD | Change.SELECTION
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
    message = Signal(str)  # what is wrong at the flag that was clicked
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
        return QSize(400, round(self._layout().height_px))

    def _on_change(self, change: Change) -> None:
        if change & LAYOUT:
            self.updateGeometry()
        if change & SHOWN:
            self.update()

    # --- geometry

    def _layout(self) -> Layout:
        """Return the lanes that are there, from top to bottom, and where each is."""
        document = self._session.document
        heights = {"audio": AUDIO_PX} if document.audio is not None else {}
        if document.visemes is not None:
            heights["visemes"] = VISEMES_PX
        heights |= {"spans": SPANS_PX, "flags": FLAGS_PX}
        if document.differences is not None:
            heights["changes"] = LANE_PX
        heights |= dict.fromkeys(lanes(document.marks), LANE_PX)
        width = max(1.0, self.width() - self._gutter - GRID - SCROLL_PX)
        return Layout(self._gutter, width, self._session.view.range, RULER_PX, tuple(heights.items()))

    def _lanes(self) -> dict[str, QRectF]:
        """Return the box of each lane, right of the gutter."""
        layout = self._layout()
        return {
            name: QRectF(layout.left_px, top, layout.width_px, bottom - top)
            for name, (top, bottom) in layout.rows().items()
        }

    def lane_box(self, name: str) -> QRectF:
        """Return where a lane is; an empty box for one that is not there."""
        return self._lanes().get(name, QRectF())

    def _hit(self, place: QPointF) -> Hit:
        marks = self._session.document.marks
        return hit(self._layout(), marks, self._flags.marks, x=place.x(), y=place.y())

    def _viseme_place(self) -> Place:
        first, last = self._session.view.range
        fps = self._session.document.take.fps
        return self.lane_box("visemes").adjusted(0, 3, 0, -3), (first / fps, last / fps)

    def x_of(self, frame: float) -> float:
        """Return the position of a frame in the widget."""
        return self._layout().x_of(frame)

    def frame_at(self, x: float) -> float:
        """Return the fractional frame at a position in the widget."""
        return self._layout().frame_at(x)

    # --- drawing

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the ruler, every lane, the selection and the playhead."""
        painter, boxes, layout = QPainter(self), self._lanes(), self._layout()
        painter.setPen(QColor(self._colours.quiet))
        left = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
        unit = "frame" if self.in_frames else "h : min : s : frame"
        painter.drawText(QRectF(GRID, 4, self._gutter, 14), left, unit)
        for name, box in boxes.items():
            painter.drawText(QRectF(GRID, box.top(), self._gutter, box.height()), left, name)
        painter.setClipRect(QRectF(self._gutter, 0, layout.width_px, self.height()))
        self._draw_selection(painter)
        draw_ticks(painter, layout, self._session.document.take.fps, self._colours, in_frames=self.in_frames)
        self._draw_audio(painter, layout)
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

    def _draw_audio(self, painter: QPainter, layout: Layout) -> None:
        session = self._session
        if session.document.audio is not None:
            first_s, last_s = (
                frame / session.document.take.fps - session.document.offset_s("audio") for frame in session.view.range
            )
            box = QRectF(self._gutter, RULER_PX + 2, layout.width_px, AUDIO_PX - 4)
            draw_waveform(painter, session.document.audio, box, (first_s, last_s), self._colours.quiet)

    # --- the mouse

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Scrub on the ruler; in a lane grab what is there, or begin to mark a span; with Shift select."""
        if event.button() != Qt.MouseButton.LeftButton:
            return
        x, under, view = event.position().x(), self._hit(event.position()), self._session.view
        grip = under.grip(selects=bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier))
        if grip is Grip.RANGE:
            self._selecting, self._marking = under.frame, under.lane == "spans"
        elif grip is Grip.SOUND:
            self._sliding = x, self._session.document.offset_s("audio")
        elif grip is not Grip.VISEME or not self.visemes.take(x):
            if under.span is not None:
                view.select((under.span.start, under.span.stop))
            view.move_playhead(under.goes_to)
            self._scrubbing = grip in (Grip.PLAYHEAD, Grip.VISEME)
            if under.flag is not None:
                self.message.emit(under.flag.sentence)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Continue what the press began; show by the pointer what a press would grab."""
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
        if self._hit(event.position()).lane == "visemes":
            self.visemes.drop()
            self.visemes.select(event.position().x())

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Offer what can be done with what lies under the pointer, and go there: the menu's actions work on it."""
        under = self._hit(QPointF(event.pos()))
        if under.lane == "visemes":
            self.visemes.open_menu(event.x(), event.globalPos(), self._colours)
            return
        if under.span is not None:
            self._session.view.select((under.span.start, under.span.stop))
        self._session.view.move_playhead(under.goes_to)
        self.menu_wanted.emit(under.kind, event.globalPos(), under.sentence)

    def told_at(self, place: QPointF) -> str:
        """Return the tool tip of a place in the widget."""
        under = self._hit(place)
        if under.flag is not None:
            return under.flag.sentence
        if isinstance(under.mark, Note):
            replies = (f"↳ {reply.text}" for reply in under.mark.replies)
            return "\n".join([under.mark.text, f"{under.mark.author}, {under.mark.time}", *replies])
        on_visemes = under.lane == "visemes" and place.x() >= self._gutter
        return (self.visemes.tool_tip(place.x()) if on_visemes else "") or HINTS.get(under.lane, HINTS[""])

    def _show_pointer(self, place: QPointF) -> None:
        self.setToolTip(tip(self.told_at(place)))
        under = self._hit(place)
        if under.lane == "visemes" and self.visemes.edge_at(place.x()) is not None:
            self.setCursor(Qt.CursorShape.SplitHCursor)
        elif under.lane == "audio":
            self.setCursor(Qt.CursorShape.SizeHorCursor)
        elif under.flag is not None:
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
