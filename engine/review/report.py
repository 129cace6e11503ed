"""Writes a review as one HTML file that needs nothing from elsewhere: no script, no font, no picture by link."""

from __future__ import annotations

import base64
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from itertools import pairwise

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from engine import assets
from engine.controls import ALL_CONTROLS
from engine.project import Note, Verdict
from engine.quality import KINDS, TABLE, Dismissal, Flag
from engine.review.changes import Change, Comparison, Edited
from engine.take import Array, Mask, Take, runs, timecode

CHART_POINTS = 1200  # of a curve drawn in the report; more cannot be told apart at its width
CHART_WIDTH, CHART_HEIGHT = 960, 64  # px
LEAST_SHOWN = 0.05  # mm or degrees that a control must change by for its curve to be drawn
FLAGS_SHOWN = 200  # the heaviest; a table of thousands is read by nobody

REGION_TITLES = {
    "face": "Whole face",
    "lower": "Mouth and jaw",
    "upper": "Eyes and brows",
    "eyes": "Eyes",
    "left": "Left side",
    "right": "Right side",
}

Draw = Callable[[Change], bytes]  # a PNG of before, after and their difference; empty for a change without one
DrawNote = Callable[[Note], bytes]  # a PNG of the face with what was drawn on it


@dataclass(frozen=True, eq=False)
class Review:
    """The content of a report.

    Attributes
    ----------
    comparison : the two takes and where they differ
    flags_before, flags_after : automatic findings on each that nobody has dismissed
    verdicts : all that were given, oldest first; the last counts
    notes : the reviewers'
    edits : in order
    dismissed : findings on the second that somebody does not mind, and who
    """

    comparison: Comparison
    flags_before: tuple[Flag, ...]
    flags_after: tuple[Flag, ...]
    verdicts: tuple[Verdict, ...] = ()
    notes: tuple[Note, ...] = ()
    edits: tuple[Edited, ...] = ()
    dismissed: tuple[tuple[Flag, Dismissal], ...] = ()

    @property
    def verdict(self) -> Verdict | None:
        """The verdict that counts; None where there is none, or the last one was taken back."""
        return self.verdicts[-1] if self.verdicts and self.verdicts[-1].judgement else None

    @property
    def new_flags(self) -> tuple[Flag, ...]:
        """Flags of the second take that meet none of their kind in the first."""
        return _unmatched(self.flags_after, self.flags_before, self._frames_of_after)

    @property
    def gone_flags(self) -> tuple[Flag, ...]:
        """Flags of the first take that meet none of their kind in the second."""
        return _unmatched(self.flags_before, self.flags_after, self._frames_of_before)

    def _frames_of_after(self, flag: Flag) -> tuple[float, float]:
        """Return a flag's frames on the first take's clock."""
        compared = self.comparison
        share, shift = compared.before.fps / compared.after.fps, compared.alignment.offset_s * compared.before.fps
        return flag.start * share + shift, flag.stop * share + shift

    def _frames_of_before(self, flag: Flag) -> tuple[float, float]:
        """Return a flag's frames on the second take's clock."""
        compared = self.comparison
        share, shift = compared.after.fps / compared.before.fps, compared.alignment.offset_s * compared.after.fps
        return flag.start * share - shift, flag.stop * share - shift


def _unmatched(
    flags: Sequence[Flag], others: Sequence[Flag], frames: Callable[[Flag], tuple[float, float]]
) -> tuple[Flag, ...]:
    def met(flag: Flag) -> bool:
        start, stop = frames(flag)
        return any(other.kind == flag.kind and other.start < stop and other.stop > start for other in others)

    return tuple(flag for flag in flags if not met(flag))


@dataclass(frozen=True)
class _Chart:
    """One control's difference as an SVG polyline, with the largest difference in its unit."""

    title: str
    points: str
    largest: float
    unit: str


@dataclass(frozen=True)
class _Row:
    """One change as the report shows it: texts, and a PNG as base64."""

    number: int
    time: str
    frames: str
    seconds: float
    change: Change
    picture: str = field(default="")


@dataclass(frozen=True)
class _Remark:
    """One note as the report shows it: texts, and a PNG as base64 of what was drawn."""

    time: str
    frames: str
    region: str
    note: Note
    picture: str = field(default="")


@dataclass(frozen=True)
class Pictures:
    """Draws the pictures of a report, each of which may be slow.

    Attributes
    ----------
    change : makes a picture of a change
    note : makes one of what was drawn with a note
    full_mm : the motion that a change's difference shows brightest
    progress : hears how many pictures are done, and of how many
    """

    change: Draw
    note: DrawNote
    full_mm: float
    progress: Callable[[int, int], None] = lambda done, of: None


def html(review: Review, *, pictures: Pictures | None = None, at: datetime | None = None) -> str:
    """Return the report as one HTML text, without pictures where nothing draws them.

    All text of files, notes and names is escaped: it is shown, never interpreted.
    """
    compared = review.comparison
    changes, notes = _drawn(review, pictures)
    heaviest = sorted(review.flags_after, key=lambda flag: -flag.weight)[:FLAGS_SHOWN]
    return (
        _environment()
        .get_template("report.html")
        .render(
            review=review,
            compared=compared,
            rows=changes,
            notes=notes,
            charts=_charts(compared),
            map=_map(compared.differs),
            counts=_counts(review),
            flags=sorted(heaviest, key=lambda flag: flag.start),
            hidden=len(review.flags_after) - len(heaviest),
            kinds=KINDS,
            regions=REGION_TITLES,
            full_mm=f"{pictures.full_mm:g}" if pictures is not None else "",
            clock=lambda frame: clock(frame, compared.after.fps),
            moment=moment,
            width=CHART_WIDTH,
            height=CHART_HEIGHT,
            written=(at or datetime.now()).strftime("%d %b %Y, %H:%M"),
        )
    )


def _drawn(review: Review, pictures: Pictures | None) -> tuple[list[_Row], list[_Remark]]:
    """Return changes and notes with their pictures."""
    compared, notes = review.comparison, sorted(review.notes, key=lambda note: note.frame)
    total = len(compared.changes) + len(notes)
    rows, remarks = [], []
    for number, change in enumerate(compared.changes, 1):
        drawn = b"" if pictures is None else pictures.change(change)
        rows.append(_row(number, change, compared.after, base64.b64encode(drawn).decode()))
        if pictures is not None:
            pictures.progress(number, total)
    for number, note in enumerate(notes, len(rows) + 1):
        drawn = b"" if pictures is None or note.drawing is None else pictures.note(note)
        remarks.append(_remark(note, compared.after.fps, base64.b64encode(drawn).decode()))
        if pictures is not None:
            pictures.progress(number, total)
    return rows, remarks


def moment(time: str) -> str:
    """Return a note's time as people read it; text that is no time as it is."""
    try:
        return datetime.fromisoformat(time).strftime("%d %b %Y, %H:%M")
    except ValueError:
        return time


@dataclass(frozen=True)
class Entry:
    """One line of the page that lists reports: a name, the report's file (empty where there is none), a sentence."""

    name: str
    link: str
    sentence: str


def index(entries: Sequence[Entry]) -> str:
    """Return the page that lists the reports of a queue."""
    return _environment().get_template("index.html").render(entries=entries)


def _environment() -> Environment:
    """Return what fills in the templates; everything put into them is escaped."""
    return Environment(
        loader=FileSystemLoader(assets.TEMPLATES), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )


def clock(frame: int, fps: float) -> str:
    """Return the time of a frame."""
    return timecode(frame / fps, fps)


def _row(number: int, change: Change, after: Take, picture: str) -> _Row:
    seconds = (change.stop - change.start) / after.fps
    return _Row(number, clock(change.start, after.fps), _frames(change.start, change.stop), seconds, change, picture)


def _remark(note: Note, fps: float, picture: str) -> _Remark:
    region = "" if note.region == "face" else REGION_TITLES.get(note.region, note.region)
    return _Remark(clock(note.frame, fps), _frames(note.frame, note.stop), region, note, picture)


def _frames(start: int, stop: int) -> str:
    return f"frame {start}" if stop - start == 1 else f"frames {start} to {stop - 1}"


def _charts(compared: Comparison) -> list[_Chart]:
    """Return the difference of each control that changed, largest first; those in one unit are drawn to one scale."""
    difference = (compared.controls[1] - compared.controls[0]) * compared.common[:, None]
    largest = np.abs(difference).max(axis=0, initial=0.0)
    scales = {
        unit: max([1e-9, *(size for size, control in zip(largest, ALL_CONTROLS, strict=True) if control.unit == unit)])
        for unit in {control.unit for control in ALL_CONTROLS}
    }
    order = [int(column) for column in np.argsort(-largest) if largest[column] > LEAST_SHOWN]
    return [
        _Chart(
            control.title, _polyline(difference[:, column], scales[control.unit]), float(largest[column]), control.unit
        )
        for column, control in ((column, ALL_CONTROLS[column]) for column in order)
    ]


def _polyline(curve: Array, scale: float) -> str:
    """Return SVG points of a curve, (frames,), of which no peak is lost: each bin keeps its lowest and highest value."""
    bins = min(len(curve), CHART_POINTS // 2)
    edges = np.linspace(0, len(curve), bins + 1).astype(int)
    points = []
    for start, stop in pairwise(edges):
        part = curve[start : max(stop, start + 1)]
        for index in sorted({int(np.argmin(part)), int(np.argmax(part))}):
            x = (start + index) / max(1, len(curve) - 1) * CHART_WIDTH
            points.append(f"{x:.1f},{CHART_HEIGHT / 2 * (1 - part[index] / scale):.1f}")
    return " ".join(points)


def _map(differs: Mask) -> list[tuple[float, float]]:
    """Return left ends and widths, in px, of the ranges that differ."""
    scale = CHART_WIDTH / max(1, len(differs))
    return [(start * scale, max(1.0, (stop - start) * scale)) for start, stop in runs(differs)]


def _counts(review: Review) -> list[tuple[str, str, int, int]]:
    """Return for each kind of flag its title, its threshold, and how many there were before and are after."""
    counts = []
    for kind in TABLE:
        before, after = (
            sum(flag.kind == kind.name for flag in flags) for flags in (review.flags_before, review.flags_after)
        )
        if before or after:
            counts.append((kind.title, kind.threshold, before, after))
    return counts
