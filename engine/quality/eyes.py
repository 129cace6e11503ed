"""What eyes do wrong: blinks that do not close, lids that blink apart from each other, blinks that never come."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from engine.anatomy import Indices
from engine.quality.record import Flag, weight_of
from engine.quality.seen import LIDS, Seen, drops, rounded
from engine.take import SHAPE_INDEX, Mask, runs

_BLINK = {side: SHAPE_INDEX[f"eyeBlink{side}"] for side in LIDS}
_DOWN = {side: SHAPE_INDEX[f"eyeLookDown{side}"] for side in LIDS}
LEASTLIDS = 0.01  # weight; eyes of a take that never go beyond are not animated


def unclosed(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield the bottoms of blinks at which the lids stay apart, farther than in most blinks of the take.

    Trackers report the blinks of some people by half: there a blink is compared with the others. Lids that are lowered
    with the gaze are left out. A blink that was shut before the edits counts wherever it is not shut any more.
    """
    gap, drop = seen.blinks
    blinks = np.flatnonzero((drop > seen.tuning.blink_drop_mm) & seen.kept)
    usual = float(np.median(gap[blinks])) if len(blinks) else 0.0
    found = np.zeros(seen.length)
    most = drop[blinks] > seen.tuning.blink_share * (gap[blinks] + drop[blinks])
    wide = gap[blinks] > max(seen.tuning.unclosed_mm, usual + seen.tuning.unlike_mm)
    open_ = blinks[most & _level(seen, blinks) & wide]
    found[open_] = gap[open_]
    for frame in _shut_before(seen):
        near = slice(max(0, frame - 2), frame + 3)
        if gap[near].min() > seen.tuning.unclosed_mm:
            found[frame] = max(found[frame], gap[frame])
    for start, stop in runs(found > 0):
        widest = float(found[start:stop].max())
        text = f"A blink leaves the lids {widest:.1f} mm apart."
        yield Flag(
            "unclosed", start, stop, weight_of(widest, seen.tuning.unclosed_mm, seen.tuning.full_unclosed_mm), text
        )


def _level(seen: Seen, frames: Indices) -> Mask:
    """Return at which of some frames the gaze is not lower than before or after the blink."""
    down = np.max([seen.weights[:, shape] for shape in _DOWN.values()], axis=0)
    within = seen.frames(seen.tuning.blink_within_s)
    beside = np.minimum(down[np.maximum(frames - within, 0)], down[np.minimum(frames + within, seen.length - 1)])
    return np.asarray(down[frames] - beside <= seen.tuning.glance)


def _shut_before(seen: Seen) -> list[int]:
    """Return the frames at which blinks were shut before the edits and the lids have no target since."""
    if seen.original_controls is None:
        return []
    before = rounded(np.max([seen.original_controls[:, control] for control in LIDS.values()], axis=0))
    shut = (
        (drops(before, seen.frames(seen.tuning.blink_within_s)) > seen.tuning.blink_drop_mm)
        & (before < seen.tuning.shut_mm)
        & seen.kept
    )
    if seen.asked is not None:
        shut &= np.isnan(seen.asked[:, list(LIDS.values())]).all(axis=1)
    return [int(frame) for frame in np.flatnonzero(shut)]


def late(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield blinks whose two lids reach the bottom at different times."""
    first, last = _around(seen, low, high)
    within = seen.frames(seen.tuning.blink_within_s)
    bottoms = [
        np.flatnonzero(
            (drops(rounded(seen.controls[first:last, control]), within) > seen.tuning.blink_drop_mm)
            & seen.kept[first:last]
        )
        for control in LIDS.values()
    ]
    late_by = np.zeros(last - first)
    for left, right in _paired(*bottoms):
        if seen.tuning.late_s * seen.fps < abs(right - left) <= seen.tuning.together_s * seen.fps:
            a, b = min(left, right), max(left, right) + 1
            late_by[a:b] = np.maximum(late_by[a:b], (b - a - 1) / seen.fps)
    late_by = late_by[low - first : high - first]
    for start, stop in runs(late_by > 0):
        most = float(late_by[start:stop].max())
        text = f"One eye blinks {most:.2f} s after the other."
        yield Flag("late", low + start, low + stop, weight_of(most, seen.tuning.late_s, seen.tuning.full_late_s), text)


def _paired(ones: Indices, others: Indices) -> list[tuple[int, int]]:
    """Return each of some frames with the nearest of some others, the earlier of two as near."""
    if not len(others):
        return []
    after = np.clip(np.searchsorted(others, ones), 0, len(others) - 1)
    before = np.maximum(after - 1, 0)
    nearer = np.where(np.abs(others[before] - ones) <= np.abs(others[after] - ones), before, after)
    return list(zip(ones.tolist(), others[nearer].tolist(), strict=True))


def unblinking(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield stretches without a blink that are longer than people leave; eyes that are not animated have none."""
    if not (seen.weights[:, list(_BLINK.values())] > LEASTLIDS).any():
        return
    marks = np.flatnonzero(
        (seen.blinks[1] > seen.tuning.blink_drop_mm) | seen.lost
    )  # a blink may hide where there is no face
    edges = np.concatenate([[-1], marks, [seen.length]])
    longest = np.flatnonzero(np.diff(edges) - 1 > seen.tuning.unblinking_s * seen.fps)
    for start, stop in zip((edges[longest] + 1).tolist(), edges[longest + 1].tolist(), strict=True):
        lasts = (stop - start) / seen.fps
        text = f"There is no blink for {lasts:.0f} s; people blink every few seconds."
        yield Flag(
            "unblinking", start, stop, weight_of(lasts, seen.tuning.unblinking_s, seen.tuning.full_unblinking_s), text
        )


def reach(seen: Seen) -> int:
    """Return how many frames to either side a verdict on a frame needs."""
    return 2 * seen.frames(seen.tuning.blink_within_s) + seen.frames(seen.tuning.together_s) + 2


def _around(seen: Seen, low: int, high: int) -> tuple[int, int]:
    return max(0, low - reach(seen)), min(seen.length, high + reach(seen))
