"""What an edit does wrong: wishes that are not reached, and borders that show."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from engine.controls import ALL_CONTROLS
from engine.quality.record import Flag, weight_of
from engine.quality.seen import Seen
from engine.take import Array, Mask, runs


def missed(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield frames on which a control misses its target."""
    if seen.asked is None:
        return
    asked, reached = seen.asked[low:high], seen.controls[low:high]
    by_mm = np.nan_to_num(np.abs(asked - reached))
    for column in np.flatnonzero((by_mm > seen.tuning.missed_mm).any(axis=0)):
        for start, stop in runs(by_mm[:, column] > seen.tuning.missed_mm):
            worst = start + int(np.argmax(by_mm[start:stop, column]))
            control = ALL_CONTROLS[column]
            text = (
                f"{control.title.capitalize()}: {asked[worst, column]:.1f} {control.unit} was asked for, "
                f"a plausible face gets to {reached[worst, column]:.1f} {control.unit}."
            )
            weight = weight_of(by_mm[worst, column], seen.tuning.missed_mm, seen.tuning.full_miss_mm)
            yield Flag("missed", low + start, low + stop, weight, text)


def seam_reach(seen: Seen) -> int:
    """Return how many frames to either side a verdict on a border needs."""
    return seen.frames(seen.tuning.seam_near_s) + 3


def seams(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield borders of edits at which a shape steps, or turns, by more than it does near there in the original.

    A border lies before frame i where one of i - 1 and i differs from the original and the other does not. With d the
    difference from the original, the step is |d_i - d_(i-1)|, the change of slope the larger of the two second
    differences of d around it, times the rate.
    """
    if seen.original_weights is None:
        return
    reach = seam_reach(seen)
    first, last = max(0, low - reach), min(seen.length, high + reach)
    now, before = seen.weights[first:last], seen.original_weights[first:last]
    changed = (now != before).any(axis=1)
    borders = np.flatnonzero(changed[1:] != changed[:-1]) + 1
    found = np.zeros((2, last - first))
    for at in borders:
        if low <= first + at < high:
            begin, end = max(0, int(at) - reach + 2), min(last - first, int(at) + reach - 2)
            found[:, at] = _seam(now[begin:end], before[begin:end], int(at) - begin, seen)
    found = found[:, low - first : high - first]
    flagged: Mask = np.asarray((found > 0).any(axis=0))
    for start, stop in runs(flagged):
        step, turn = found[:, start:stop].max(axis=1)
        what = f"steps by {step:.2f}" if step > 0 else f"turns sharply (by {turn:.1f} a second)"
        weight = weight_of(step, seen.tuning.seam, seen.tuning.full_seam) if step > 0 else weight_of(0.0, 0.0, 1.0)
        yield Flag("seam", low + start, low + stop, weight, f"A shape {what} at the border of an edit.")


def _seam(now: Array, before: Array, at: int, seen: Seen) -> tuple[float, float]:
    """Return the step and the change of slope per second at a border; 0 where the take's own motion hides them."""
    difference = now - before
    step = np.abs(difference[at] - difference[at - 1])
    own = np.abs(np.diff(before, axis=0)).max(axis=0)
    steps = step[(step > seen.tuning.seam) & (step > own)].max(initial=0.0)
    turn = np.abs(np.diff(difference[max(0, at - 2) : at + 2], n=2, axis=0)).max(axis=0, initial=0.0) * seen.fps
    own_turn = np.abs(np.diff(before, n=2, axis=0)).max(axis=0, initial=0.0) * seen.fps
    turns = turn[(turn > seen.tuning.seam_slope) & (turn > own_turn)].max(initial=0.0)
    return float(steps), float(turns)
