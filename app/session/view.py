"""The view state: the playhead, the frames and lanes on screen, the selection, the tool and the shown head."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QObject, Signal

from app.session.changes import Change
from app.session.curve_table import CURVES, FIRST_WEIGHT, weights_under
from app.session.document import Document
from engine.character import Character
from engine.controls import CONTROLS
from engine.editing import DEFAULT_BELIEVABILITY

FIRST_VIEW_S = 16.0
LEAST_FRAMES = 8.0  # on screen
BRUSH_S, RADII_S = 0.5, (0.01, 10.0)  # of the brush: at first, and from a single frame to a whole phrase


class View(QObject):
    """Holds what is shown of a document and the tool in use; nothing of it is stored in a project.

    Parameters
    ----------
    document : the document that is shown

    Attributes
    ----------
    playhead : frame
    range : first and last frame on screen, fractional
    selection : half-open range of frames, or None
    lane : the curve that is worked on, an index into CURVES
    expanded : controls whose weights are shown below them
    added : controls beyond the eight that have a lane
    tool : name of the tool that the mouse works with in the lanes
    radius_s, strength : the brush: to how far on either side it reaches, and its share of what is pulled
    believability : of edits, 0 where they go wherever curves are pulled, 1 where they do only what was recorded
    shows_removed : whether the Clean tool draws what it would remove
    head : the head that the take is shown on; None for the bundled one
    """

    changed = Signal(object)  # a Change; the session passes it on

    def __init__(self, document: Document) -> None:
        super().__init__()
        self._document = document
        self.strength, self.believability, self.tool = 1.0, DEFAULT_BELIEVABILITY, "drag"
        self.shows_removed = True
        self.head: Character | None = None
        self.reset()

    def reset(self) -> None:
        """Show the beginning of another take, with the same tool; emits nothing."""
        take = self._document.take
        self.playhead = 0
        self.range = (0.0, float(min(len(take) - 1, FIRST_VIEW_S * take.fps)) or 1.0)
        self.selection: tuple[int, int] | None = None
        self.lane = 0
        self.expanded: frozenset[int] = frozenset()
        self.added = frozenset(np.flatnonzero(~np.isnan(self._document.asked).all(axis=0)).tolist())
        self.radius_s = BRUSH_S

    # --- time

    def move_playhead(self, frame: int) -> None:
        """Go to a frame, the nearest that exists; the frames on screen follow it."""
        frame = int(np.clip(frame, 0, len(self._document.take) - 1))
        if frame == self.playhead:
            return
        self.playhead = frame
        self.changed.emit(Change.PLAYHEAD)
        first, last = self.range
        if not first <= frame <= last:
            middle = (last - first) * (0.1 if frame > last else 0.9)
            self.set_range(frame - middle, frame - middle + last - first)

    def set_range(self, first: float, last: float) -> None:
        """Show these frames, at least eight and no more than there are."""
        end = float(max(1, len(self._document.take) - 1))
        width = float(np.clip(last - first, min(LEAST_FRAMES, end), end))
        first = float(np.clip(first, 0.0, end - width))
        if (first, first + width) != self.range:
            self.range = (first, first + width)
            self.changed.emit(Change.VIEW)

    def zoom(self, factor: float, around: float) -> None:
        """Show fewer or more frames, keeping frame `around` where it is on screen."""
        first, last = self.range
        self.set_range(around - (around - first) / factor, around + (last - around) / factor)

    def select(self, frames: tuple[int, int] | None) -> None:
        """Choose the range that tools and the loop work on."""
        if frames is not None:
            start, stop = sorted(int(np.clip(frame, 0, len(self._document.take))) for frame in frames)
            frames = (start, stop) if stop > start else None
        if frames != self.selection:
            self.selection = frames
            self.changed.emit(Change.SELECTION)

    # --- lanes

    @property
    def lanes(self) -> list[int]:
        """The curves on screen from top to bottom, as indices into CURVES."""
        shown: list[int] = []
        for control in range(FIRST_WEIGHT):
            if control >= len(CONTROLS) and control not in self.added:
                continue
            shown.append(control)
            if control in self.expanded:
                shown += [lane for lane in weights_under(control) if lane not in shown]
        return shown

    def choose_lane(self, lane: int) -> None:
        """Work on another curve."""
        if lane != self.lane and 0 <= lane < len(CURVES):
            self.lane = lane
            self.changed.emit(Change.LANE)

    def expand(self, lane: int) -> None:
        """Show the weights under a control, or put them away, named by the control or one of them."""
        above = [control for control in sorted(self.expanded) if lane in weights_under(control)]
        control = above[0] if lane >= FIRST_WEIGHT and above else lane
        if 0 <= control < FIRST_WEIGHT:
            self.expanded ^= {control}
            if self.lane not in self.lanes:
                self.lane = control
            self.changed.emit(Change.LANES | Change.LANE)

    def add_lane(self, control: int, *, shown: bool = True) -> None:
        """Give a control beyond the eight a lane, or take it away."""
        added = self.added | {control} if shown else self.added - {control}
        if added != self.added and len(CONTROLS) <= control < FIRST_WEIGHT:
            self.added = added
            if self.lane not in self.lanes:
                self.lane = 0
            elif shown:
                self.lane = control
            self.changed.emit(Change.LANES | Change.LANE)

    # --- the face

    def show_on(self, head: Character | None) -> None:
        """Show the take on another head; None is the bundled one."""
        if head is not self.head:
            self.head = head
            self.changed.emit(Change.HEAD)

    # --- tools

    def choose_tool(self, name: str) -> None:
        """Let the mouse work with another tool."""
        if name != self.tool:
            self.tool = name
            self.changed.emit(Change.TOOL)

    def show_removed(self, *, shown: bool) -> None:
        """Let the Clean tool draw what it would remove, or not."""
        if shown != self.shows_removed:
            self.shows_removed = shown
            self.changed.emit(Change.TOOL)

    @property
    def radius_frames(self) -> float:
        """How many frames the brush's radius comes to."""
        return self.radius_s * self._document.take.fps

    def set_brush(
        self,
        *,
        radius_s: float | None = None,
        strength: float | None = None,
        believability: float | None = None,
    ) -> None:
        """Change the Drag tool."""
        if radius_s is not None:
            self.radius_s = float(np.clip(radius_s, *RADII_S))
        if strength is not None:
            self.strength = float(np.clip(strength, 0.0, 1.0))
        if believability is not None:
            self.believability = float(np.clip(believability, 0.0, 1.0))
        self.changed.emit(Change.TOOL)
