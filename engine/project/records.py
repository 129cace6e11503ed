"""What a project holds, as plain data, and how its edits play out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from datetime import datetime
from typing import Any

import numpy as np

from engine.controls import ALL_CONTROLS
from engine.formats.base.reading import ReadAs, Reading
from engine.project.reviewing import Note, Verdict, note_of, verdict_from
from engine.quality.settings import Dismissal, FlagSettings
from engine.take import SHAPES, Array, Mask, Take

MARK = "mark"  # kind of an edit whose inputs are marks before and after
ALIGN = "align"  # kind of an edit that puts the take before, not the take itself, at another time
FILL = "fill"  # kind of an edit that gave every one of its frames motion
VISEMES = "visemes"  # kind of an edit whose inputs are a step on the visemes lane
SLOWEST_FPS, FASTEST_FPS = 0.01, 10_000.0
READING = "reading"  # kind of an edit whose inputs are how the take is read before and after


@dataclass(frozen=True, eq=False)
class Edit:
    """One finished step of the user; an object is one step for ever, so identity tells whether it is stored.

    Attributes
    ----------
    kind : the verb, such as drag or fill
    title : what the user did, as the Undo menu shows it
    start : first frame
    weights : (frames, 52) what the edit put in place; no frames where it changed none
    asked : (frames, 16), control targets up to and including this edit; NaN for none
    inputs : its request as JSON values, so that it can be run again
    lost : (frames,) bool, which of its frames are lost after it; None in projects that did not say so yet
    """

    kind: str
    title: str
    start: int
    weights: Array
    asked: Array
    inputs: Mapping[str, Any] = field(default_factory=dict)
    lost: Mask | None = None

    @property
    def stop(self) -> int:
        """The frame after the last."""
        return self.start + len(self.weights)

    @property
    def changes_frames(self) -> bool:
        """Whether it put other rows into the take."""
        return self.kind != ALIGN and len(self.weights) > 0

    def still_lost(self, weights: Array, lost: Mask) -> Mask:
        """Return which of its frames are lost after it, (frames,), where it found these weights and these lost frames."""
        if self.lost is not None:
            return self.lost
        kept: Mask = lost & (self.weights == weights).all(axis=1)
        return np.zeros_like(kept) if self.kind == FILL else kept


@dataclass(frozen=True)
class Span:
    """Frames start to stop (half-open) of a region, marked for work; kind is who marked it: lost, user."""

    start: int
    stop: int
    region: str = "face"
    kind: str = "user"


@dataclass(frozen=True)
class Pin:
    """Weights by shape name that must be met exactly at a frame; the change spreads over start to stop (half-open)."""

    frame: int
    weights: Mapping[str, float]
    start: int
    stop: int


@dataclass(frozen=True)
class Media:
    """Audio or video beside the curves.

    Attributes
    ----------
    kind : audio or video
    path : relative to the project's folder, with forward slashes; a file elsewhere goes by its name alone
    sha256 : of its bytes, hexadecimal
    offset_s : time of the take's first frame within it
    """

    kind: str
    path: str
    sha256: str
    offset_s: float = 0.0


@dataclass(frozen=True)
class Marks:
    """What people put beside the curves.

    Attributes
    ----------
    verdicts : all that were given, oldest first; the last counts
    dismissals : findings that somebody does not mind
    flags : what is looked for
    """

    spans: tuple[Span, ...] = ()
    pins: tuple[Pin, ...] = ()
    notes: tuple[Note, ...] = ()
    media: tuple[Media, ...] = ()
    verdicts: tuple[Verdict, ...] = ()
    dismissals: tuple[Dismissal, ...] = ()
    flags: FlagSettings = field(default_factory=FlagSettings)

    @property
    def verdict(self) -> str:
        """The verdict that counts, with its reason; empty where there is none."""
        return self.verdicts[-1].sentence if self.verdicts else ""

    def medium(self, kind: str) -> Media | None:
        """Return the sound (audio) or the reference video (video), None where there is none."""
        return next((media for media in self.media if media.kind == kind), None)

    def with_medium(self, kind: str, media: Media | None) -> Marks:
        """Return the same marks with another sound or video, or without."""
        others = tuple(other for other in self.media if other.kind != kind)
        return replace(self, media=(*others, media) if media is not None else others)


def marks_of(stored: Mapping[str, Any]) -> Marks:
    """Return marks from their `dataclasses.asdict` form; raises `KeyError` or `TypeError` for anything else."""
    return Marks(
        spans=tuple(Span(**entry) for entry in stored["spans"]),
        pins=tuple(Pin(**entry) for entry in stored["pins"]),
        notes=tuple(note_of(entry) for entry in stored["notes"]),
        media=tuple(Media(**entry) for entry in stored["media"]),
        verdicts=_verdicts_of(stored),
        dismissals=tuple(Dismissal(**entry) for entry in stored.get("dismissals", ())),
        flags=FlagSettings(**stored.get("flags", {})),
    )


def _verdicts_of(stored: Mapping[str, Any]) -> tuple[Verdict, ...]:
    if "verdicts" in stored:
        return tuple(Verdict(**entry) for entry in stored["verdicts"])
    if not isinstance(stored["verdict"], str):  # as projects told it that kept the last one alone
        raise TypeError("a verdict is a text")
    return verdict_from(stored["verdict"])


def mark_edit(title: str, before: Marks, after: Marks) -> Edit:
    """Return the edit that changes marks and no frame."""
    rows = np.zeros((0, len(SHAPES))), np.zeros((0, len(ALL_CONTROLS)))
    return Edit(MARK, title, 0, *rows, {"before": asdict(before), "after": asdict(after)})


def reading_edit(title: str, before: ReadAs, after: ReadAs) -> Edit:
    """Return the edit that changes how the take is read and no frame."""
    rows = np.zeros((0, len(SHAPES))), np.zeros((0, len(ALL_CONTROLS)))
    return Edit(READING, title, 0, *rows, {"before": asdict(before), "after": asdict(after)})


def read_as_of(stored: Mapping[str, Any]) -> ReadAs:
    """Return a reading from its `dataclasses.asdict` form.

    Raises `KeyError`, `TypeError` or `EditError` for anything else.
    """
    fps, swapped = stored["fps"], stored["swapped"]
    if type(swapped) is not bool or type(fps) is not float or not SLOWEST_FPS <= fps <= FASTEST_FPS:
        raise TypeError("a reading has a rate, and sides that are exchanged or not")
    chosen = stored["chosen"]
    if type(chosen["fps"]) not in (float, int, type(None)) or not isinstance(chosen["sides"], str):
        raise TypeError("a choice is a rate and sides, or left open")
    return ReadAs(Reading(**chosen), fps, swapped)


@dataclass(frozen=True, eq=False)
class Contents:
    """All that a project holds.

    Attributes
    ----------
    original : the take as it was opened
    edits : oldest first, those that were undone last
    position : how many of them are in effect
    """

    original: Take
    edits: tuple[Edit, ...] = ()
    position: int = 0
    marks: Marks = Marks()


@dataclass(frozen=True)
class Summary:
    """What a project is, without reading all of it: the take's name and length, edits in effect, last change, verdict."""

    name: str
    frames: int
    fps: float
    edits: int
    changed: datetime
    verdict: Verdict | None = None
