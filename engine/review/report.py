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
from engine.controls import CONTROLS
from engine.quality import KINDS, Flag
from engine.review.changes import Change, Comparison, Edited
from engine.take import Array, Mask, Take, runs, timecode

CHART_POINTS = 1200  # of a curve drawn in the report; more cannot be told apart at its width
CHART_WIDTH, CHART_HEIGHT = 960, 64  # px
FLAGS_SHOWN = 200  # the heaviest; a table of thousands is read by nobody

REGION_TITLES = {
    "face": "Whole face",
    "lower": "Mouth and jaw",
    "upper": "Eyes and brows",
    "eyes": "Eyes",
    "left": "Left side",
    "right": "Right side",
}

Draw = Callable[[Change], bytes]  # a PNG of before, after and their difference


@dataclass(frozen=True)
class Remark:
    """A reviewer's note as the report shows it."""

    frame: int
    author: str
    time: str
    text: str


@dataclass(frozen=True, eq=False)
class Review:
    """What a report tells.

    Attributes
    ----------
    comparison : the two takes and where they differ
    flags_before, flags_after : automatic findings on each
    verdict : approved, needs work, or nothing yet
    remarks, edits : the reviewer's notes, and the edits in order
    """

    comparison: Comparison
    flags_before: tuple[Flag, ...]
    flags_after: tuple[Flag, ...]
    verdict: str = ""
    remarks: tuple[Remark, ...] = ()
    edits: tuple[Edited, ...] = ()

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
    """One control's difference as an SVG polyline, with the largest difference in mm."""

    title: str
    points: str
    largest_mm: float


@dataclass(frozen=True)
class _Row:
    """One change as the report shows it: texts, and a PNG as base64."""

    number: int
    time: str
    frames: str
    seconds: float
    change: Change
    picture: str = field(default="")


def html(review: Review, *, draw: Draw | None = None, full_mm: float = 0.0, at: datetime | None = None) -> str:
    """Return the report as one HTML text; `draw` makes a picture of each change, and may be slow;
    `full_mm` is the motion that its difference shows brightest.

    All text of files, notes and names is escaped: it is shown, never interpreted.
    """
    compared = review.comparison
    rows = []
    for number, change in enumerate(compared.changes, 1):
        picture = "" if draw is None else base64.b64encode(draw(change)).decode()
        rows.append(_row(number, change, compared.after, picture))
    heaviest = sorted(review.flags_after, key=lambda flag: -flag.weight)[:FLAGS_SHOWN]
    return (
        _environment()
        .get_template("report.html")
        .render(
            review=review,
            compared=compared,
            rows=rows,
            charts=_charts(compared),
            map=_map(compared.differs),
            counts=_counts(review),
            flags=sorted(heaviest, key=lambda flag: flag.start),
            hidden=len(review.flags_after) - len(heaviest),
            kinds=KINDS,
            regions=REGION_TITLES,
            full_mm=f"{full_mm:g}",
            clock=lambda frame: clock(frame, compared.after.fps),
            width=CHART_WIDTH,
            height=CHART_HEIGHT,
            made=(at or datetime.now()).strftime("%d %b %Y, %H:%M"),
        )
    )


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
    return _Row(
        number,
        clock(change.start, after.fps),
        f"frame {change.start}" if change.stop - change.start == 1 else f"frames {change.start} to {change.stop - 1}",
        (change.stop - change.start) / after.fps,
        change,
        picture,
    )


def _charts(compared: Comparison) -> list[_Chart]:
    """Return the difference of each control that changed, largest first."""
    difference = (compared.controls[1] - compared.controls[0]) * compared.common[:, None]
    largest = np.abs(difference).max(axis=0, initial=0.0)
    scale = max(float(largest.max(initial=0.0)), 1e-9)
    order = [int(column) for column in np.argsort(-largest) if largest[column] > 0.01]
    return [
        _Chart(CONTROLS[column].title, _polyline(difference[:, column], scale), float(largest[column]))
        for column in order
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


def _counts(review: Review) -> list[tuple[str, int, int]]:
    """Return for each kind of flag its title and how many there were before and are after."""
    counts = []
    for kind, title in KINDS.items():
        before, after = (
            sum(flag.kind == kind for flag in flags) for flags in (review.flags_before, review.flags_after)
        )
        if before or after:
            counts.append((title, before, after))
    return counts
