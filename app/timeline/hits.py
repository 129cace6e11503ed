"""Which lane, frame and thing lies under a place of the timeline: arithmetic alone, without a widget.

A place is in pixels from the timeline's left and upper edge. With first and last frame on screen f and l, the left end of
the lanes at g and their width w, frame t stands at x(t) = g + (t - f) / (l - f) w.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, auto
from typing import TYPE_CHECKING

from engine.project import Marks, Note, Pin, Span

if TYPE_CHECKING:
    from app.timeline.flags import Mark

NEAR_PX = 8  # how far beside a pin or a note it may be clicked
FLAG_NEAR_PX = 5.5  # and beside a flag


@dataclass(frozen=True)
class Layout:
    """Where the lanes are, and which frames they show.

    Attributes
    ----------
    left_px, width_px : of the lanes
    range : first and last frame on screen, fractional
    ruler_px : height of the ruler, beneath which the lanes begin
    heights_px : of each lane, by its name, from top to bottom
    """

    left_px: float
    width_px: float
    range: tuple[float, float]
    ruler_px: float
    heights_px: tuple[tuple[str, float], ...]

    @property
    def height_px(self) -> float:
        """Of the ruler and all lanes."""
        return self.ruler_px + sum(height for _, height in self.heights_px)

    def rows(self) -> dict[str, tuple[float, float]]:
        """Return the upper and the lower edge of each lane, from top to bottom."""
        found, top = {}, self.ruler_px
        for name, height in self.heights_px:
            found[name] = top, top + height
            top += height
        return found

    def lane_at(self, y: float) -> str:
        """Return the name of the lane at a height; nothing on the ruler and below the last."""
        return next((name for name, (top, bottom) in self.rows().items() if top < y <= bottom), "")

    def x_of(self, frame: float) -> float:
        """Return the place of a frame."""
        first, last = self.range
        return self.left_px + (frame - first) / max(1e-9, last - first) * self.width_px

    def frame_at(self, x: float) -> float:
        """Return the fractional frame at a place."""
        first, last = self.range
        return first + (x - self.left_px) / self.width_px * (last - first)


class Grip(Enum):
    """What a press grabs."""

    SPAN = auto()
    FLAG = auto()
    MARK = auto()  # a pin or a note
    RANGE = auto()  # a selection, that becomes a span in the lane of spans
    SOUND = auto()
    VISEME = auto()
    PLAYHEAD = auto()


@dataclass(frozen=True)
class Hit:
    """What lies under a place.

    Attributes
    ----------
    lane : by name; nothing on the ruler
    frame : nearest to the place
    span, flag, mark : what of these lies there in their lanes
    """

    lane: str
    frame: int
    span: Span | None = None
    flag: Mark | None = None
    mark: Note | Pin | None = None

    def grip(self, *, selects: bool) -> Grip:
        """Return what a press grabs; `selects` is whether it is one that selects."""
        for there, grip in ((self.span, Grip.SPAN), (self.flag, Grip.FLAG), (self.mark, Grip.MARK)):
            if there is not None:
                return grip
        if self.lane == "spans" or selects:
            return Grip.RANGE
        return {"audio": Grip.SOUND, "visemes": Grip.VISEME}.get(self.lane, Grip.PLAYHEAD)

    @property
    def kind(self) -> str:
        """The kind of thing that a menu is for."""
        if self.span is not None:
            return "span"
        if self.flag is not None:
            return "flag"
        if self.mark is not None:
            return "note" if isinstance(self.mark, Note) else "pin"
        return "audio" if self.lane == "audio" else "time"

    @property
    def goes_to(self) -> int:
        """The frame to go to: where what lies there begins, or is."""
        if self.span is not None:
            return self.span.start
        if self.flag is not None:
            return self.flag.flag.start
        return self.mark.frame if self.mark is not None else self.frame

    @property
    def sentence(self) -> str:
        """What a menu says of it."""
        if self.flag is not None and self.span is None:
            return self.flag.flag.sentence
        return self.mark.text if isinstance(self.mark, Note) else ""


def hit(layout: Layout, marks: Marks, flags: Sequence[Mark], *, x: float, y: float) -> Hit:
    """Return what lies under a place, where the flags are drawn as these marks."""
    lane, at = layout.lane_at(y), layout.frame_at(x)
    frame = round(at)
    if lane == "spans":
        return Hit(lane, frame, span=next((each for each in marks.spans if each.start <= frame < each.stop), None))
    if lane == "flags":
        return Hit(lane, frame, flag=nearest_flag(flags, x))
    return Hit(lane, frame, mark=nearest_mark(marks, lane, at, layout.frame_at(x + NEAR_PX) - at))


def nearest_flag(flags: Sequence[Mark], x: float) -> Mark | None:
    """Return the flag that is drawn nearest to a place, none where that is too far."""
    near = [mark for mark in flags if abs(mark.x - x) <= FLAG_NEAR_PX]
    return min(near, key=lambda mark: abs(mark.x - x), default=None)


def nearest_mark(marks: Marks, name: str, frame: float, within: float) -> Note | Pin | None:
    """Return the pin or note, by the name of its lane, that lies nearest to a frame and no further than `within` frames."""
    listed: Sequence[Note | Pin] = marks.pins if name == "pins" else marks.notes if name == "notes" else ()
    near = [mark for mark in listed if _away(mark, frame) <= within]
    return min(near, key=lambda mark: (_away(mark, frame), abs(mark.frame - frame)), default=None)


def _away(mark: Note | Pin, frame: float) -> float:
    """Return how far a frame is from a pin, or from the frames of a note."""
    if isinstance(mark, Pin) or frame <= mark.frame:
        return abs(mark.frame - frame)
    return max(0.0, frame - (mark.stop - 1))
