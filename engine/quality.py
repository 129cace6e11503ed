"""What a reviewer should look at: flags on frames that a tracker spoilt or an edit could not do well.

Each frame's verdict depends on itself and its two neighbours alone, so that after an edit only the frames near it are
looked at again; lips that should meet are looked for where they should, and those places are few.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from engine.anatomy import BOTH, EXCLUSIVE, Indices, clash
from engine.controls import ALL_CONTROLS, CONTROL_INDEX
from engine.errors import EditError
from engine.extended import bundled_face
from engine.speech.lane import VisemeLane
from engine.speech.visemes import NAMES
from engine.take import Array, Mask, Take, runs
from engine.words import counted

# What is flagged, and what to call it.
KINDS: dict[str, str] = {
    "lost": "no face",
    "spike": "a spike",
    "frozen": "frozen frames",
    "impossible": "no face does this",
    "missed": "asked for, not reached",
    "open": "lips stay open",
}
LEAP, RETURNS = 0.15, 0.05  # weight: a shape that leaps this far for a frame and comes back to within this is a spike
FULL_LEAP = 0.5  # of the heaviest spike
REPEATS = 2  # frames like the one before: a single one is what a source of another rate leaves behind
FULL_FREEZE_S = 0.5
FULL_LOSS_S = 1.0
MISSED_MM, FULL_MISS_MM = 2.0, 8.0
CLOSED_MM, FULL_GAP_MM = 2.0, 8.0
BRIEF_S = 0.25  # lips that meet for longer rest
LEAST = 0.2  # weight of the lightest flag
_CHUNK = 4096  # frames that fit the cache
_LIPS = CONTROL_INDEX["lips_vertical"]
_MBP = NAMES.index("mbp")


@dataclass(frozen=True)
class Flag:
    """An automatic finding on the frames start to stop (half-open), of `KINDS`; weight is 0..1, the heaviest 1."""

    kind: str
    start: int
    stop: int
    weight: float
    sentence: str


@dataclass(frozen=True, eq=False)
class Seen:
    """What is looked at.

    Attributes
    ----------
    weights : (frames, 52)
    controls : (frames, 16), measured on the weights
    fps : frames per second
    lost : (frames,) bool, where the tracker had no face and nobody has filled one in since
    asked : (frames, 16), NaN where nothing was asked; None where nothing was anywhere
    original_controls : (frames, 16) before any edit; None without one
    visemes : what is said when
    """

    weights: Array
    controls: Array
    fps: float
    lost: Mask
    asked: Array | None = None
    original_controls: Array | None = None
    visemes: VisemeLane | None = None

    @cached_property
    def length(self) -> int:
        """Number of frames."""
        return len(self.weights)


def seen_of(
    take: Take,
    original: Take | None = None,
    asked: Array | None = None,
    visemes: VisemeLane | None = None,
    *,
    controls: tuple[Array, Array] | None = None,
) -> Seen:
    """Return what there is to look at in a take, beside the one that it was made from.

    Parameters
    ----------
    asked : (frames, 16), NaN where nothing was asked
    controls : of the take and of the original, (frames, 16) each, where they have been measured

    Raises `EditError` for an original of another length.
    """
    if original is None:
        measured = bundled_face().measure(take.weights) if controls is None else controls[0]
        return Seen(take.weights, measured, take.fps, take.lost, asked, None, visemes)
    if len(original) != len(take):
        raise EditError(
            f"The original has {counted(len(original), 'frame')}, the take {len(take)}.",
            "Name the take that was edited.",
        )
    measure = bundled_face().measure
    now, before = controls if controls is not None else (measure(take.weights), measure(original.weights))
    return Seen(take.weights, now, take.fps, take.lost, asked, before, visemes)


def repeats(weights: Array, kept: Mask) -> Mask:
    """Return which frames, (frames,) bool, are the very frame before; only `kept` ones count."""
    same = np.zeros(len(weights), bool)
    same[1:] = kept[1:] & kept[:-1] & (weights[1:] == weights[:-1]).all(axis=1)
    return same


def leaps(weights: Array, kept: Mask) -> Array:
    """Return how far the shape that leaps furthest for a single frame does, (frames,); 0 where none leaps and returns."""
    found = np.zeros(len(weights))
    if len(weights) < 3:
        return found
    before, now, after = weights[:-2], weights[1:-1], weights[2:]
    leap = np.abs(now - (after + before) / 2)
    leap[(leap <= LEAP) | (np.abs(after - before) >= RETURNS)] = 0.0
    found[1:-1] = leap.max(axis=1) * (kept[:-2] & kept[1:-1] & kept[2:])
    return found


def flags_of(seen: Seen) -> tuple[Flag, ...]:
    """Return every flag of a take, by their first frame."""
    return _sorted([*_over(seen, 0, seen.length), *_open(seen)])


def flags_after(flags: Sequence[Flag], seen: Seen, touched: tuple[int, int]) -> tuple[Flag, ...]:
    """Return what `flags_of` would, looking again only near the frames that an edit touched, [start, stop)."""
    local = [flag for flag in flags if flag.kind != "open"]
    reach = 1 + REPEATS  # a verdict needs a neighbour, and repeats too few for a flag may become enough
    low, high = max(0, touched[0] - reach), min(seen.length, touched[1] + reach)
    grown = True
    while grown:  # a flag that is cut in two or joined to another is looked at as a whole
        near = [flag for flag in local if flag.start <= high and flag.stop >= low]
        wider = min([low, *(flag.start for flag in near)]), max([high, *(flag.stop for flag in near)])
        grown, (low, high) = wider != (low, high), wider
    away = [flag for flag in local if flag.stop < low or flag.start > high]
    return _sorted([*away, *_over(seen, low, high), *_open(seen)])


def _sorted(flags: Iterable[Flag]) -> tuple[Flag, ...]:
    return tuple(sorted(flags, key=lambda flag: (flag.start, flag.kind, flag.stop, flag.sentence)))


def _weight(share: float) -> float:
    # rounded so that it is the same whether curves were measured whole or in parts
    return round(float(min(1.0, LEAST + (1 - LEAST) * share)), 9)


def _over(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield the flags of the frames [low, high) that need no more than a frame to either side."""
    kept: Mask = ~seen.lost
    same, leap = np.zeros(high - low, bool), np.zeros(high - low)
    strength, which = np.zeros(high - low), np.zeros(high - low, np.int64)
    for start in range(low, high, _CHUNK):
        stop = min(high, start + _CHUNK)
        first, last = max(0, start - 1), min(seen.length, stop + 1)
        rows, inside = seen.weights[first:last], slice(start - first, stop - first)
        here = slice(start - low, stop - low)
        same[here] = repeats(rows, kept[first:last])[inside]
        leap[here] = leaps(rows, kept[first:last])[inside]
        strength[here], which[here] = clash(rows[inside])
    yield from _lost(seen, low, high)
    yield from _frozen(same, low, seen.fps)
    yield from _spikes(leap, low)
    yield from _impossible(strength, which, low)
    yield from _missed(seen, low, high)


def _lost(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    for start, stop in runs(seen.lost[low:high]):
        text = f"The tracker had no face for {_lasting(stop - start, seen.fps)}; the curves are guessed here."
        yield Flag("lost", low + start, low + stop, _weight((stop - start) / seen.fps / FULL_LOSS_S), text)


def _frozen(same: Mask, low: int, fps: float) -> Iterator[Flag]:
    for start, stop in runs(same):
        if stop - start >= REPEATS:
            text = f"The face does not move at all for {_lasting(stop - start + 1, fps)}."
            yield Flag("frozen", low + start, low + stop, _weight((stop - start) / fps / FULL_FREEZE_S), text)


def _spikes(leap: Array, low: int) -> Iterator[Flag]:
    for start, stop in runs(leap > 0):
        furthest = float(leap[start:stop].max())
        text = f"A shape leaps by {furthest:.2f} for a single frame and comes back."
        yield Flag("spike", low + start, low + stop, _weight((furthest - LEAP) / (FULL_LEAP - LEAP)), text)


def _impossible(strength: Array, which: Indices, low: int) -> Iterator[Flag]:
    for start, stop in runs(strength > BOTH):
        worst = start + int(np.argmax(strength[start:stop]))
        first, second, reason = EXCLUSIVE[which[worst]]
        text = f"{first} and {second} are both at {strength[worst]:.2f} or more: {reason}."
        yield Flag("impossible", low + start, low + stop, _weight((strength[worst] - BOTH) / (1 - BOTH)), text)


def _missed(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    if seen.asked is None:
        return
    asked, reached = seen.asked[low:high], seen.controls[low:high]
    by_mm = np.nan_to_num(np.abs(asked - reached))
    for column in np.flatnonzero((by_mm > MISSED_MM).any(axis=0)):
        for start, stop in runs(by_mm[:, column] > MISSED_MM):
            worst = start + int(np.argmax(by_mm[start:stop, column]))
            control = ALL_CONTROLS[column]
            text = (
                f"{control.title.capitalize()}: {asked[worst, column]:.1f} {control.unit} was asked for, "
                f"a plausible face gets to {reached[worst, column]:.1f} {control.unit}."
            )
            share = (by_mm[worst, column] - MISSED_MM) / (FULL_MISS_MM - MISSED_MM)
            yield Flag("missed", low + start, low + stop, _weight(share), text)


def _open(seen: Seen) -> Iterator[Flag]:
    """Yield places where lips should meet and never do: M, B and P, and where they met before the edits."""
    lips = seen.controls[:, _LIPS]
    said, labels = _said(seen)
    for (start, stop), nearest, label in zip(said.tolist(), _lowest(lips, said), labels, strict=True):
        if nearest > CLOSED_MM:
            text = f"The lips stay {nearest:.1f} mm apart where {label} is said."
            yield Flag("open", start, stop, _weight((nearest - CLOSED_MM) / (FULL_GAP_MM - CLOSED_MM)), text)
    met = _met(seen)
    for (start, stop), nearest in zip(met.tolist(), _lowest(lips, met), strict=True):
        if nearest > CLOSED_MM:
            text = f"The lips met here before the edits and now stay {nearest:.1f} mm apart."
            yield Flag("open", start, stop, _weight((nearest - CLOSED_MM) / (FULL_GAP_MM - CLOSED_MM)), text)


def _lowest(curve: Array, ranges: Indices) -> Array:
    """Return the least of a curve, (frames,), over each of the half-open ranges, (n, 2)."""
    padded = np.append(curve, np.inf)  # a range may end with the curve
    return np.asarray(np.minimum.reduceat(padded, ranges.reshape(-1))[::2] if len(ranges) else np.zeros(0))


def _said(seen: Seen) -> tuple[Indices, list[str]]:
    """Return the frames over which lips should meet, (n, 2), as far as the take goes, and the labels that say so."""
    lane = seen.visemes
    if lane is None:
        return np.zeros((0, 2), np.int64), []
    shut = np.flatnonzero(lane.classes == _MBP)
    frames = np.round(lane.times_s[shut] * seen.fps).astype(np.int64)
    frames[:, 1] = np.maximum(frames[:, 1], frames[:, 0] + 1)
    frames = np.clip(frames, 0, seen.length)
    within = frames[:, 0] < frames[:, 1]
    return frames[within], [lane.cues[index].label for index in shut[within]]


def _met(seen: Seen) -> Indices:
    """Return where the lips met briefly as the take was opened and nobody has asked anything of them since, (n, 2)."""
    if seen.original_controls is None:
        return np.zeros((0, 2), np.int64)
    met = np.array(runs(seen.original_controls[:, _LIPS] < CLOSED_MM), np.int64).reshape(-1, 2)
    settled = seen.lost if seen.asked is None else seen.lost | ~np.isnan(seen.asked[:, _LIPS])
    before = np.append(0, np.cumsum(settled))
    free = before[met[:, 1]] == before[met[:, 0]]
    return np.asarray(met[free & (np.diff(met, axis=1)[:, 0] <= BRIEF_S * seen.fps)])


def _lasting(frames: int, fps: float) -> str:
    return counted(frames, "frame") + (f" ({frames / fps:.2f} s)" if frames > 1 else "")
