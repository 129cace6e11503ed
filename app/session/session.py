"""The one owner of what is open: the take, its curves, the playhead, the view, the undo stack."""

from __future__ import annotations

from collections.abc import Iterable
from enum import Flag, auto
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoCommand, QUndoStack

from app.session.curve_table import CURVES, FIRST_WEIGHT, weights_under
from engine import quality
from engine.character import Character
from engine.controls import CONTROLS
from engine.extended import bundled_face
from engine.formats import livelink
from engine.formats.audio import Audio
from engine.formats.base.reading import ReadAs
from engine.project import Contents, Marks, Replayed, Span
from engine.speech.lane import VisemeLane
from engine.take import Array, Mask, Take, runs

if TYPE_CHECKING:
    from engine.editing import Patch

FIRST_VIEW_S = 16.0
DEFAULT_BELIEVABILITY = 0.5  # as in engine.regress.plausibility, which takes torch to load
BRUSH_S, RADII_S = 0.5, (0.01, 10.0)  # of the brush: at first, and from a single frame to a whole phrase
MAX_OFFSET_S = 36_000.0  # of sound and video
MEDIA = ("audio", "video")  # the kinds that may be attached


class Change(Flag):
    """What kind of thing changed."""

    TAKE = auto()  # another take was opened: everything
    CURVES = auto()  # weights, and with them the controls
    DRAFT = auto()  # what the edit under way would do
    PLAYHEAD = auto()
    VIEW = auto()  # which frames are on screen
    SELECTION = auto()  # the range that tools and playback work on
    LANE = auto()  # the lane that is worked on
    LANES = auto()  # which lanes there are
    TOOL = auto()
    SAVED = auto()
    MEDIA = auto()  # sound or reference video
    MARKS = auto()  # spans, pins, notes, media or the verdict
    VISEMES = auto()  # what is said when
    FLAGS = auto()  # what was found automatically
    CHARACTER = auto()  # whose head the weights are for
    REVIEW = auto()  # where the take differs from the recording
    READING = auto()  # the frame rate, or the sides of mouth and jaw, that the take is read with


class Session(QObject):
    """State and one signal; widgets read it, commands change it.

    Attributes
    ----------
    take : as edited so far; its lost frames are those that nothing has given motion yet
    recorded : as opened
    original : the same, read as it is read by now
    reading : what that is
    controls : (frames, 16) measured on `take`
    original_controls : (frames, 16) measured on `original`
    asked : (frames, 16) what the edits asked for; NaN where nothing was asked
    draft : what the drag under way would do, None between drags
    playhead : frame
    view : first and last frame on screen, fractional
    selection : half-open range of frames, or None
    lane : the curve that is worked on, an index into CURVES
    expanded : controls whose weights are shown below them
    tool : name of the tool that the mouse works with in the lanes
    radius_s, strength : the brush: to how far on either side it reaches, and its share of what is pulled
    believability : of edits, 0 where they go wherever curves are pulled, 1 where they do only what was recorded
    added : controls beyond the eight that have a lane
    shows_removed : whether the Clean tool draws what it would remove
    audio : the recording of the sound, None where there is none, or it is not found
    video : the file of the reference video, likewise
    sliding : the kind of what is being moved in time, and where it is by now; None between moves
    marks : spans, pins, notes, media and verdict
    visemes : what is said when, or None
    flags : what was found automatically, by the first frame; None while it is looked for
    differences : half-open ranges of frames that differ from the recording; None while nobody looks
    touched : the half-open range of frames that changed last
    character : whose head the weights are for; None for the bundled one
    """

    changed = Signal(object)

    def __init__(self, take: Take) -> None:
        super().__init__()
        self.undo = QUndoStack(self)
        self.path: Path | None = None
        self.strength, self.believability, self.tool = 1.0, DEFAULT_BELIEVABILITY, "drag"
        self.shows_removed = True
        self._restoring = False
        self._open_spans: tuple[Take, Marks, tuple[Span, ...]] | None = None
        self.character: Character | None = None
        self.open(take, None)
        self.undo.cleanChanged.connect(self._on_clean_changed)

    def open(self, take: Take, path: Path | None, measured: Array | None = None) -> None:
        """Replace everything by a take, whose controls may have been measured before, (frames, 16)."""
        self.take = self.original = self.recorded = take
        self.reading = livelink.read_as(take)
        self.path = path
        if measured is None:
            measured = _measured(take)
        self.controls = self.original_controls = measured
        self.asked = np.full_like(measured, np.nan)
        self.marks = Marks(spans=tuple(Span(start, stop, kind="lost") for start, stop in runs(take.lost)))
        self.visemes: VisemeLane | None = None
        self.flags: tuple[quality.Flag, ...] | None = None
        self.differences: tuple[tuple[int, int], ...] | None = None
        self.touched = (0, len(take))
        self.draft: Patch | None = None
        self.selection: tuple[int, int] | None = None
        self.lane = 0
        self.expanded: frozenset[int] = frozenset()
        self.added = frozenset(np.flatnonzero(~np.isnan(self.asked).all(axis=0)).tolist())
        self.radius_s = BRUSH_S
        self.playhead = 0
        self.view = (0.0, float(min(len(take) - 1, FIRST_VIEW_S * take.fps)) or 1.0)
        other_head, self.character = self.character is not None, None
        self.audio: Audio | None = None
        self.video: Path | None = None
        self.sliding: tuple[str, float] | None = None
        self.undo.clear()
        self.changed.emit(Change.TAKE | Change.CHARACTER if other_head else Change.TAKE)

    def restore(
        self,
        contents: Contents,
        path: Path | None,
        steps: Iterable[QUndoCommand],
        state: Replayed,
        measured: tuple[Array, Array],
    ) -> None:
        """Replace everything by what a project holds: its edits as `steps`, which come to `state`.

        The controls, (frames, 16), are `measured` of the original as it is read there, and of that state.
        """
        self.blockSignals(True)
        self._restoring = True
        try:
            self.open(contents.original, path, measured[0])
            for step in steps:
                self.undo.push(step)
            self.undo.setIndex(contents.position)
            self.undo.setClean()
        finally:
            self._restoring = False
            self.blockSignals(False)
        self.take, self.asked, self.marks = state.take, state.asked, contents.marks
        self.original = state.original or contents.original
        self.reading = state.reading or self.reading
        self.visemes = state.visemes
        self.controls = measured[1]
        self.added = frozenset(np.flatnonzero(~np.isnan(self.asked).all(axis=0)).tolist())
        self.changed.emit(Change.TAKE)

    def contents(self) -> Contents:
        """Return all that a project file keeps; a step without an `edit` (one that changed no rows) is no part of it."""
        edits = [getattr(self.undo.command(index), "edit", None) for index in range(self.undo.count())]
        undone = sum(edit is not None for edit in edits[self.undo.index() :])
        kept = tuple(edit for edit in edits if edit is not None)
        return Contents(self.recorded, kept, len(kept) - undone, self.marks)

    def set_marks(self, marks: Marks) -> None:
        """Put other spans, pins, notes, media or another verdict in place."""
        if marks != self.marks:
            media = marks.media != self.marks.media
            self.marks = marks
            self.changed.emit(Change.MARKS | Change.MEDIA if media else Change.MARKS)

    def set_visemes(self, visemes: VisemeLane | None) -> None:
        """Put another visemes lane in place; for commands only."""
        if visemes is not self.visemes and not self._restoring:
            self.visemes = visemes
            self.changed.emit(Change.VISEMES)

    def read_as(self, reading: ReadAs) -> None:
        """Read the open take with another rate or other sides, its edits with it; for commands only."""
        if self._restoring:
            return  # what the steps come to is known
        exchanged = reading.swapped != self.reading.swapped
        self.take, self.original = livelink.put(self.take, reading), livelink.put(self.original, reading)
        self.reading = reading
        if exchanged:
            self.controls, self.original_controls = _measured(self.take), _measured(self.original)
        self.draft = None
        self.touched = (0, len(self.take))
        told = Change.READING | Change.CURVES | Change.DRAFT | Change.VIEW | Change.MARKS | Change.MEDIA
        self.changed.emit(told | Change.VISEMES | Change.SELECTION)

    def set_flags(self, flags: tuple[quality.Flag, ...]) -> None:
        """Show what was found automatically."""
        self.flags = flags
        self.changed.emit(Change.FLAGS)

    def set_differences(self, ranges: tuple[tuple[int, int], ...] | None) -> None:
        """Show where the take differs from the recording, or no longer."""
        if ranges != self.differences:
            self.differences = ranges
            self.changed.emit(Change.REVIEW)

    def play_on(self, character: Character | None) -> None:
        """Say whose head the weights are for; None is the bundled one."""
        self.character = character
        self.changed.emit(Change.CHARACTER)

    def _on_clean_changed(self, _: bool) -> None:
        self.changed.emit(Change.SAVED)

    @property
    def name(self) -> str:
        """What to call the open take."""
        return self.path.name if self.path else self.take.name

    @property
    def open_spans(self) -> tuple[Span, ...]:
        """The spans that are to be worked on: all but lost ones that a kept fill gave a face."""
        if self._open_spans is None or self._open_spans[0] is not self.take or self._open_spans[1] is not self.marks:
            still = self._lost_before()
            spans = (each for each in self.marks.spans if each.kind != "lost" or still[each.stop] > still[each.start])
            self._open_spans = (self.take, self.marks, tuple(spans))
        return self._open_spans[2]

    def _lost_before(self) -> Array:
        """Return how many frames without a face lie before each frame, (frames + 1,): lost ones that nobody changed since."""
        if not any(span.kind == "lost" for span in self.marks.spans):
            return np.zeros(len(self.take) + 1)
        lost = self.take.lost & (self.take.weights == self.original.weights).all(axis=1)
        return np.append(0, np.cumsum(lost))

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

    def curve(self, lane: int) -> Array:
        """Return a curve as edited so far, (frames,)."""
        source = self.take.weights if CURVES[lane].is_weight else self.controls
        return np.asarray(source[:, CURVES[lane].column])

    def original_curve(self, lane: int) -> Array:
        """Return a curve as opened, (frames,)."""
        source = self.original.weights if CURVES[lane].is_weight else self.original_controls
        return np.asarray(source[:, CURVES[lane].column])

    def asked_curve(self, lane: int) -> Array | None:
        """Return what the edits asked of a curve, (frames,) with NaN where nothing was asked; None for a weight."""
        return None if CURVES[lane].is_weight else np.asarray(self.asked[:, CURVES[lane].column])

    def draft_curve(self, lane: int) -> Array | None:
        """Return what a curve would become in the frames of the draft, (n,)."""
        if self.draft is None:
            return None
        source = self.draft.weights if CURVES[lane].is_weight else self.draft.reached
        return np.asarray(source[:, CURVES[lane].column])

    @property
    def radius_frames(self) -> float:
        """How many frames the brush's radius comes to."""
        return self.radius_s * self.take.fps

    def value(self, lane: int, frame: int) -> float:
        """Return the value to show at a frame: the draft's where it has one."""
        draft = self.draft
        if draft is not None and draft.start <= frame < draft.stop:
            drafted = self.draft_curve(lane)
            assert drafted is not None
            return float(drafted[frame - draft.start])
        return float(self.curve(lane)[frame])

    def replace_rows(self, start: int, weights: Array, controls: Array, asked: Array, lost: Mask) -> None:
        """Put rows of weights, controls, asked values and lost frames in place; for commands only."""
        if self._restoring:
            return  # what the steps come to is known
        stop = start + len(weights)
        self.take = self.take.with_exact_rows(start, weights, lost)
        self.controls = _with_rows(self.controls, start, controls)
        self.asked = _with_rows(self.asked, start, asked)
        self.draft = None
        self.touched = (start, stop)
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

    def attach_audio(self, audio: Audio | None) -> None:
        """Play a recording along with the take, or none."""
        self.audio = audio
        self.changed.emit(Change.MEDIA)

    def attach_video(self, path: Path | None) -> None:
        """Show a reference video beside the face, or none."""
        self.video = path
        self.changed.emit(Change.MEDIA)

    def offset_s(self, kind: str) -> float:
        """Return the time in the take at which the sound (audio) or the video begins."""
        if self.sliding is not None and self.sliding[0] == kind:
            return self.sliding[1]
        record = self.marks.medium(kind)
        return 0.0 - record.offset_s if record is not None else 0.0

    def slide(self, kind: str, offset_s: float | None) -> None:
        """Show what another beginning of the sound or the video does; None goes back to what is kept."""
        limit = MAX_OFFSET_S
        self.sliding = (kind, float(np.clip(offset_s, -limit, limit))) if offset_s is not None else None
        self.changed.emit(Change.MEDIA)

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


def _measured(take: Take) -> Array:
    controls = bundled_face().measure(take.weights)
    controls.flags.writeable = False
    return controls


def _with_rows(array: Array, start: int, rows: Array) -> Array:
    copy = array.copy()
    copy[start : start + len(rows)] = rows
    copy.flags.writeable = False
    return copy
