"""Lists where two takes differ: ranges of frames with region, amount, the control that moved most, and who changed it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from engine.character import bundled
from engine.controls import ALL_CONTROLS
from engine.extended import bundled_face
from engine.inpaint.regions import REGIONS
from engine.review.align import Alignment, align, on_clock_of
from engine.take import Array, Mask, Take, runs

_IN_MM = np.array([control.unit == "mm" for control in ALL_CONTROLS])


@dataclass(frozen=True)
class Tuning:
    """Constants of the list of changes.

    Attributes
    ----------
    same : weight; smaller differences are rounding of a resampled clock, not a change [1e-6 .. 1e-3]
    join_s : seconds; changes closer together are one [0.1 .. 0.5]; an eased edit stays one change
    region_share : of a change's squared motion that must lie in a region for it to be named [0.8 .. 0.98]
    """

    same: float = 1e-4
    join_s: float = 0.2
    region_share: float = 0.9


@dataclass(frozen=True)
class Change:
    """Frames start to stop (half-open) in which two takes differ.

    Attributes
    ----------
    peak : the frame at which they differ most
    region : where on the face: lower, eyes, upper, left, right or face
    weight : largest difference of a weight
    moved_mm : furthest that a point of the bundled head moved at the peak
    control, by_mm : the title of the control in mm that changed most, and by how much at the peak, signed
    edits : titles of the edits that touch these frames, where they are known
    """

    start: int
    stop: int
    peak: int
    region: str
    weight: float
    moved_mm: float
    control: str
    by_mm: float
    edits: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Comparison:
    """Two takes on the second one's clock.

    Attributes
    ----------
    before, after : the takes as they were read
    alignment : how one lies on the other's clock
    weights : (frames, 52), the first take at the second one's frames
    common : (frames,) bool, where both have a frame
    differs : (frames,) bool, where they differ
    controls : (2, frames, 16) in the units of `ALL_CONTROLS`, of the first and of the second
    changes : in order of time
    """

    before: Take
    after: Take
    alignment: Alignment
    weights: Array
    common: Mask
    differs: Mask
    controls: Array
    changes: tuple[Change, ...]

    @property
    def identical(self) -> int:
        """Number of common frames that are the same bit for bit (or, on another clock, within rounding)."""
        return int((self.common & ~self.differs).sum())


@dataclass(frozen=True)
class Edited:
    """The title of an edit and the frames start to stop that it changed."""

    title: str
    start: int
    stop: int


def compare(before: Take, after: Take, *, offset_s: float | None = None, edits: Sequence[Edited] = ()) -> Comparison:
    """Return where `after` differs from `before`; `edits` tell who changed it. Raises `EditError` with no common frame."""
    alignment = align(before, after, offset_s=offset_s)
    weights, common = on_clock_of(after, before, alignment.offset_s)
    difference = np.abs(after.weights - weights)
    largest = difference.max(axis=1)
    differs: Mask = common & (largest > (0.0 if _one_clock(before, after, alignment) else Tuning.same))
    measure = bundled_face().measure
    controls = np.stack([measure(weights), measure(after.weights)])
    found = [
        _change((start, stop), weights, after.weights, controls, edits)
        for start, stop in _joined(runs(differs), max(1, round(Tuning.join_s * after.fps)))
    ]
    return Comparison(before, after, alignment, weights, common, differs, controls, tuple(found))


def _one_clock(before: Take, after: Take, alignment: Alignment) -> bool:
    """Return whether frames coincide, so that equal means equal to the last bit."""
    at = alignment.offset_s * before.fps
    return before.fps == after.fps and abs(at - round(at)) < 1e-3


def _joined(ranges: Sequence[tuple[int, int]], gap: int) -> list[tuple[int, int]]:
    joined: list[tuple[int, int]] = []
    for start, stop in ranges:
        if joined and start - joined[-1][1] <= gap:
            joined[-1] = (joined[-1][0], stop)
        else:
            joined.append((start, stop))
    return joined


def _change(frames: tuple[int, int], before: Array, after: Array, controls: Array, edits: Sequence[Edited]) -> Change:
    start, stop = frames
    difference = after[start:stop] - before[start:stop]
    squares = (difference**2).sum(axis=0)
    peak = start + int(np.argmax((difference**2).sum(axis=1)))
    by_mm = controls[1, peak] - controls[0, peak]
    column = int(np.argmax(np.where(_IN_MM, np.abs(by_mm), 0.0)))
    head = bundled()
    moved = np.linalg.norm(head.vertices(after[peak]) - head.vertices(before[peak]), axis=1)
    titles = tuple(dict.fromkeys(edit.title for edit in edits if edit.start < stop and edit.stop > start))
    return Change(
        start=start,
        stop=stop,
        peak=peak,
        region=_region(squares),
        weight=float(np.abs(difference).max()),
        moved_mm=float(moved.max()),
        control=ALL_CONTROLS[column].title,
        by_mm=float(by_mm[column]),
        edits=titles,
    )


def _region(squares: Array) -> str:
    """Return the smallest region that holds nearly all of a change's squared motion, (52,)."""
    total = float(squares.sum())
    sizes = sorted((int(mask.sum()), name) for name, mask in REGIONS.items())
    for _, name in sizes:
        if squares[REGIONS[name]].sum() >= Tuning.region_share * total:
            return name
    return "face"
