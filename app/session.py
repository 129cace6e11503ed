"""The one owner of what is open: the take, its curves, the playhead, the view, the undo stack."""

from __future__ import annotations

from enum import Flag, auto
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoStack

from engine.controls import CONTROLS, bundled_measurer
from engine.take import Array, Take

if TYPE_CHECKING:
    from engine.editing import Patch

FIRST_VIEW_S = 16.0
BRUSH_S = 0.5


class Change(Flag):
    """What kind of thing changed."""

    TAKE = auto()  # another take was opened: everything
    CURVES = auto()  # weights, and with them the controls
    DRAFT = auto()  # what the edit under way would do
    PLAYHEAD = auto()
    VIEW = auto()  # which frames are on screen
    SELECTION = auto()  # the range that tools and playback work on
    LANE = auto()  # the lane that is worked on
    TOOL = auto()
    SAVED = auto()


class Session(QObject):
    """State and one signal; widgets read it, commands change it.

    Attributes
    ----------
    take : as edited so far
    original : as opened
    controls : (frames, 8) mm, measured on `take`
    original_controls : (frames, 8) mm, measured on `original`
    asked : (frames, 8) mm, what the edits asked for; NaN where nothing was asked
    draft : what the drag under way would do, None between drags
    playhead : frame
    view : first and last frame on screen, fractional
    selection : half-open range of frames, or None
    lane : column of the control that is worked on
    radius_frames, strength, exact : the Drag tool's brush
    """

    changed = Signal(object)

    def __init__(self, take: Take) -> None:
        super().__init__()
        self.undo = QUndoStack(self)
        self.path: Path | None = None
        self.strength, self.exact = 1.0, False
        self.open(take, None)
        self.undo.cleanChanged.connect(self._on_clean_changed)

    def open(self, take: Take, path: Path | None) -> None:
        """Replace everything by a take."""
        self.take = self.original = take
        self.path = path
        measured = bundled_measurer().measure(take.weights)
        measured.flags.writeable = False
        self.controls = self.original_controls = measured
        self.asked = np.full_like(measured, np.nan)
        self.draft: Patch | None = None
        self.selection: tuple[int, int] | None = None
        self.lane = 0
        self.radius_frames = max(2, round(BRUSH_S * take.fps))
        self.playhead = 0
        self.view = (0.0, float(min(len(take) - 1, FIRST_VIEW_S * take.fps)) or 1.0)
        self.undo.clear()
        self.changed.emit(Change.TAKE)

    def _on_clean_changed(self, _: bool) -> None:
        self.changed.emit(Change.SAVED)

    @property
    def name(self) -> str:
        """What to call the open take."""
        return self.path.name if self.path else self.take.name

    @property
    def edited(self) -> bool:
        """Whether there are edits that are not saved."""
        return not self.undo.isClean()

    def frame_weights(self, frame: int) -> Array:
        """Return the weights to show at a frame, (52,): the draft's where it has them."""
        draft = self.draft
        if draft is not None and draft.start <= frame < draft.stop:
            return np.asarray(draft.weights[frame - draft.start])
        return np.asarray(self.take.weights[frame])

    def shown_controls(self, frame: int) -> Array:
        """Return the controls to show at a frame, (8,) mm."""
        draft = self.draft
        if draft is not None and draft.start <= frame < draft.stop:
            return np.asarray(draft.reached[frame - draft.start])
        return np.asarray(self.controls[frame])

    def replace_rows(self, start: int, weights: Array, controls: Array, asked: Array) -> None:
        """Put rows of weights, controls and asked values in place; for commands only."""
        stop = start + len(weights)
        self.take = self.take.with_rows(start, weights)
        self.controls = _with_rows(self.controls, start, controls)
        self.asked = _with_rows(self.asked, start, asked)
        self.draft = None
        self.changed.emit(Change.CURVES | Change.DRAFT)
        assert stop <= len(self.take)

    def set_draft(self, draft: Patch | None) -> None:
        """Show what an edit under way would do, or nothing."""
        self.draft = draft
        self.changed.emit(Change.DRAFT)

    def move_playhead(self, frame: int) -> None:
        """Go to a frame, the nearest that exists; the view follows it."""
        frame = int(np.clip(frame, 0, len(self.take) - 1))
        if frame == self.playhead:
            return
        self.playhead = frame
        self.changed.emit(Change.PLAYHEAD)
        first, last = self.view
        if not first <= frame <= last:
            middle = (last - first) * (0.1 if frame > last else 0.9)
            self.set_view(frame - middle, frame - middle + last - first)

    def set_view(self, first: float, last: float) -> None:
        """Show these frames, at least eight and no more than there are."""
        end = float(max(1, len(self.take) - 1))
        width = float(np.clip(last - first, min(8.0, end), end))
        first = float(np.clip(first, 0.0, end - width))
        if (first, first + width) != self.view:
            self.view = (first, first + width)
            self.changed.emit(Change.VIEW)

    def zoom_view(self, factor: float, around: float) -> None:
        """Show fewer or more frames, keeping frame `around` where it is on screen."""
        first, last = self.view
        self.set_view(around - (around - first) / factor, around + (last - around) / factor)

    def select(self, frames: tuple[int, int] | None) -> None:
        """Choose the range that tools and the loop work on."""
        if frames is not None:
            start, stop = sorted(int(np.clip(frame, 0, len(self.take))) for frame in frames)
            frames = (start, stop) if stop > start else None
        if frames != self.selection:
            self.selection = frames
            self.changed.emit(Change.SELECTION)

    def choose_lane(self, lane: int) -> None:
        """Work on another control."""
        if lane != self.lane and 0 <= lane < len(CONTROLS):
            self.lane = lane
            self.changed.emit(Change.LANE)

    def set_brush(
        self, *, radius_frames: int | None = None, strength: float | None = None, exact: bool | None = None
    ) -> None:
        """Change the Drag tool."""
        if radius_frames is not None:
            self.radius_frames = int(np.clip(radius_frames, 1, 300))
        if strength is not None:
            self.strength = float(np.clip(strength, 0.0, 1.0))
        if exact is not None:
            self.exact = exact
        self.changed.emit(Change.TOOL)


def _with_rows(array: Array, start: int, rows: Array) -> Array:
    copy = array.copy()
    copy[start : start + len(rows)] = rows
    copy.flags.writeable = False
    return copy
