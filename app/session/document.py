"""What is edited and kept: the take, its curves, its marks and the undo stack."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoCommand, QUndoStack

from app.session.changes import Change
from app.session.curve_table import CURVES
from engine import quality
from engine.character import Character
from engine.extended import bundled_face
from engine.formats import livelink
from engine.formats.audio import Audio
from engine.formats.base.reading import ReadAs
from engine.project import Contents, Marks, Replayed, Span
from engine.speech.lane import VisemeLane
from engine.take import Array, Mask, Take, runs

if TYPE_CHECKING:
    from engine.editing import Patch

MAX_OFFSET_S = 36_000.0  # of sound and video
MEDIA = ("audio", "video")  # the kinds that may be attached


class Document(QObject):
    """State and the steps on it; the session passes its signal on.

    Attributes
    ----------
    take : as edited so far; its lost frames are those that nothing has given motion yet
    recorded : as opened
    original : the same, read as it is read by now
    reading : what that is
    path : the file that it came from, or None
    undo : the steps
    opening : whether a take or a project is being put in place: nothing is told, and no step changes anything
    controls : (frames, 16) measured on `take`
    original_controls : (frames, 16) measured on `original`
    asked : (frames, 16) what the edits asked for; NaN where nothing was asked
    draft : what the drag under way would do, None between drags
    marks : spans, pins, notes, media and verdict
    visemes : what is said when, or None
    audio : the recording of the sound, None where there is none, or it is not found
    video : the file of the reference video, likewise
    sliding : the kind of what is being moved in time, and where it is by now; None between moves
    flags : what was found automatically, by the first frame; None while it is looked for
    dismissed : findings that the user dismissed, which are no `flags`
    differences : half-open ranges of frames that differ from the recording; None outside a review
    touched : the half-open range of frames that changed last
    character : whose head the weights are for; None for the bundled one
    """

    changed = Signal(object)  # a Change

    def __init__(self, take: Take) -> None:
        super().__init__()
        self.undo = QUndoStack(self)
        self.opening = False
        self._open_spans: tuple[Take, Marks, tuple[Span, ...]] | None = None
        self.open(take, None)
        self.undo.cleanChanged.connect(self._on_clean_changed)

    def _tell(self, change: Change) -> None:
        if not self.opening:
            self.changed.emit(change)

    def open(self, take: Take, path: Path | None, measured: Array | None = None) -> None:
        """Replace everything by a take, whose controls may have been measured before, (frames, 16); emits nothing."""
        self.opening = True
        try:
            self._put(take, path, measured if measured is not None else _measured(take))
            self.undo.clear()
        finally:
            self.opening = False

    def _put(self, take: Take, path: Path | None, measured: Array) -> None:
        self.take = self.original = self.recorded = take
        self.reading = livelink.read_as(take)
        self.path = path
        self.controls = self.original_controls = measured
        self.asked = np.full_like(measured, np.nan)
        self.draft: Patch | None = None
        self.marks = Marks(spans=tuple(Span(start, stop, kind="lost") for start, stop in runs(take.lost)))
        self.visemes: VisemeLane | None = None
        self.audio: Audio | None = None
        self.video: Path | None = None
        self.sliding: tuple[str, float] | None = None
        self.flags: tuple[quality.Flag, ...] | None = None
        self.dismissed: tuple[quality.Flag, ...] = ()
        self.differences: tuple[tuple[int, int], ...] | None = None
        self.touched = (0, len(take))
        self.character: Character | None = None

    def restore(
        self,
        contents: Contents,
        path: Path | None,
        steps: Iterable[QUndoCommand],
        state: Replayed,
        measured: tuple[Array, Array],
    ) -> None:
        """Replace everything by a project's contents: its edits as `steps`, which result in `state`; emits nothing.

        The controls, (frames, 16), are `measured` of the original as it is read there, and of that state.
        """
        self.open(contents.original, path, measured[0])
        self.opening = True
        try:
            for step in steps:
                self.undo.push(step)
            self.undo.setIndex(contents.position)
            self.undo.setClean()
        finally:
            self.opening = False
        self.take, self.asked, self.marks = state.take, state.asked, contents.marks
        self.original = state.original or contents.original
        self.reading = state.reading or self.reading
        self.visemes = state.visemes
        self.controls = measured[1]

    def contents(self) -> Contents:
        """Return all that a project file keeps; a step without an `edit` (one that changed no rows) is no part of it."""
        edits = [getattr(self.undo.command(index), "edit", None) for index in range(self.undo.count())]
        undone = sum(edit is not None for edit in edits[self.undo.index() :])
        kept = tuple(edit for edit in edits if edit is not None)
        return Contents(self.recorded, kept, len(kept) - undone, self.marks)

    # --- what the steps change

    def replace_rows(self, start: int, weights: Array, controls: Array, asked: Array, lost: Mask) -> None:
        """Put rows of weights, controls, asked values and lost frames in place; for commands only."""
        if self.opening:
            return  # what the steps come to is known
        stop = start + len(weights)
        self.take = self.take.with_exact_rows(start, weights, lost)
        self.controls = _with_rows(self.controls, start, controls)
        self.asked = _with_rows(self.asked, start, asked)
        self.draft = None
        self.touched = (start, stop)
        self._tell(Change.CURVES | Change.DRAFT)
        assert stop <= len(self.take)

    def set_original(self, weights: Array, lost: Mask) -> None:
        """Put another take before the edits in place, of the same frames; for commands only."""
        if self.opening:
            return  # what the steps come to is known
        self.original = replace(self.original, weights=weights, lost=lost)
        self.original_controls = _measured(self.original)
        self.touched = (0, len(self.take))
        self._tell(Change.READING | Change.CURVES | Change.DRAFT)

    def set_marks(self, marks: Marks) -> None:
        """Put other spans, pins, notes, media or another verdict in place."""
        if marks != self.marks and not self.opening:
            media = marks.media != self.marks.media
            self.marks = marks
            self._tell(Change.MARKS | Change.MEDIA if media else Change.MARKS)

    def set_visemes(self, visemes: VisemeLane | None) -> None:
        """Put another visemes lane in place; for commands only."""
        if visemes is not self.visemes and not self.opening:
            self.visemes = visemes
            self._tell(Change.VISEMES)

    def read_as(self, reading: ReadAs) -> None:
        """Read the open take with another rate or other sides, its edits with it; for commands only."""
        if self.opening:
            return  # what the steps come to is known
        exchanged = reading.swapped != self.reading.swapped
        self.take, self.original = livelink.put(self.take, reading), livelink.put(self.original, reading)
        self.reading = reading
        if exchanged:
            self.controls, self.original_controls = _measured(self.take), _measured(self.original)
        self.draft = None
        self.touched = (0, len(self.take))
        changed = Change.READING | Change.CURVES | Change.DRAFT | Change.VIEW | Change.MARKS | Change.MEDIA
        self._tell(changed | Change.VISEMES | Change.SELECTION)

    # --- what is no step

    def set_draft(self, draft: Patch | None) -> None:
        """Show what an edit under way would do, or nothing."""
        self.draft = draft
        self._tell(Change.DRAFT)

    def set_flags(self, flags: tuple[quality.Flag, ...], dismissed: tuple[quality.Flag, ...] = ()) -> None:
        """Set the flags that were found, and those that the user dismissed."""
        self.flags, self.dismissed = flags, dismissed
        self._tell(Change.FLAGS)

    def set_differences(self, ranges: tuple[tuple[int, int], ...] | None) -> None:
        """Show where the take differs from the recording, or no longer."""
        if ranges != self.differences:
            self.differences = ranges
            self._tell(Change.REVIEW)

    def play_on(self, character: Character | None) -> None:
        """Say whose head the weights are for; None is the bundled one."""
        self.character = character
        self._tell(Change.CHARACTER)

    def attach_audio(self, audio: Audio | None) -> None:
        """Play a recording along with the take, or none."""
        self.audio = audio
        self._tell(Change.MEDIA)

    def attach_video(self, path: Path | None) -> None:
        """Show a reference video beside the face, or none."""
        self.video = path
        self._tell(Change.MEDIA)

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
        self._tell(Change.MEDIA)

    # --- what can be read of it

    @property
    def name(self) -> str:
        """What to call the open take."""
        return self.path.name if self.path else self.take.name

    @property
    def edited(self) -> bool:
        """Whether there are edits that are not saved."""
        return not self.undo.isClean()

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

    def frame_weights(self, frame: int) -> Array:
        """Return the weights to show at a frame, (52,): the draft's where it has them."""
        draft = self.draft
        if draft is not None and draft.start <= frame < draft.stop:
            return np.asarray(draft.weights[frame - draft.start])
        return np.asarray(self.take.weights[frame])

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

    def value(self, lane: int, frame: int) -> float:
        """Return the value to show at a frame: the draft's where it has one."""
        draft = self.draft
        if draft is not None and draft.start <= frame < draft.stop:
            drafted = self.draft_curve(lane)
            assert drafted is not None
            return float(drafted[frame - draft.start])
        return float(self.curve(lane)[frame])

    def _on_clean_changed(self, _: bool) -> None:
        self._tell(Change.SAVED)


def _measured(take: Take) -> Array:
    controls = bundled_face().measure(take.weights)
    controls.flags.writeable = False
    return controls


def _with_rows(array: Array, start: int, rows: Array) -> Array:
    copy = array.copy()
    copy[start : start + len(rows)] = rows
    copy.flags.writeable = False
    return copy
