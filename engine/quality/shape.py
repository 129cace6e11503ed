"""Faces that are none: excluding shapes, weights out of range, exchanged sides, lips and lids through each other."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from engine.anatomy import EXCLUSIVE, Indices, pairs
from engine.character import bundled
from engine.errors import AssetError
from engine.formats.livelink.sides import EXCHANGED, PULLING, judge
from engine.jaw import limited
from engine.likeness import recorded
from engine.quality.record import Flag, weight_of
from engine.quality.seen import Seen, strengths
from engine.quality.tuning import Tuning
from engine.take import SHAPE_INDEX, SHAPES, Array, Mask, runs
from engine.words import counted

_GAZE = np.array([name.startswith("eyeLook") for name in SHAPES])
_SIDES = ("Left", "Right")
_TELLING = 20_000  # frames that tell the sides; of a longer take every second one, every third, ...
_MEETING = (
    ("lip", "lip_inner_upper", "lip_inner_lower"),
    ("lid", "lid_upper_right", "lid_lower_right"),
    ("lid", "lid_upper_left", "lid_lower_left"),
)


def impossible(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield frames with two shapes that exclude each other, beyond what people were recorded to do."""
    limits = _limits(seen.tuning)
    beyond = strengths(seen, low, high, reach=0, verdict=lambda weights, _: _clash_beyond(weights, limits)[0])
    for start, stop in runs(beyond > 0):
        worst = start + int(np.argmax(beyond[start:stop]))
        _, which = _clash_beyond(seen.weights[low + worst : low + worst + 1], limits)
        first, second, reason = EXCLUSIVE[which[0]]
        least = float(limits[which[0]])
        strength = least + beyond[worst]
        text = f"{first} and {second} are both at {strength:.2f} or more: {reason}."
        yield Flag("impossible", low + start, low + stop, weight_of(strength, least, 1.0), text)


def _limits(tuning: Tuning) -> Array:
    """Return how strong both shapes of each row of `EXCLUSIVE` may be, (rows,)."""
    wide = max(tuning.both, tuning.both_wide)
    return np.array([wide if second == "mouthStretch" else tuning.both for _, second, _ in EXCLUSIVE])


def _clash_beyond(weights: Array, limits: Array) -> tuple[Array, Indices]:
    """Return by how much the worst pair of each frame of weights, (frames, 52), is beyond its limit, and its row."""
    columns = np.ascontiguousarray(weights.T)
    worst, which = np.full(len(weights), -np.inf), np.zeros(len(weights), np.int64)
    for first, second, row in pairs():
        beyond = np.minimum(columns[first], columns[second]) - limits[row]
        which[beyond > worst] = row
        np.maximum(worst, beyond, out=worst)
    return worst, which


def out_of_range(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield frames with a weight that is negative or above 1 by more than rounding, or than trackers report of gaze."""
    most = np.where(_GAZE, max(seen.tuning.most_weight, seen.tuning.most_gaze), seen.tuning.most_weight)

    def verdict(weights: Array, kept: Mask) -> Array:
        beyond = np.maximum(seen.tuning.least_weight - weights.min(axis=1), (weights - most).max(axis=1))
        return np.asarray(np.where(kept, beyond, 0.0))

    beyond = strengths(seen, low, high, reach=0, verdict=verdict)
    for start, stop in runs(beyond > 0):
        row = seen.weights[low + start + int(np.argmax(beyond[start:stop]))]
        worst = int(np.argmax(np.maximum(seen.tuning.least_weight - row, row - most)))
        text = f"{SHAPES[worst]} is at {row[worst]:.2f}; weights go from 0 to 1."
        weight = weight_of(float(beyond[start:stop].max()), 0.0, seen.tuning.full_beyond)
        yield Flag("range", low + start, low + stop, weight, text)


def swapped(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield the whole take where the mouth goes to one side and the other side's muscles pull."""
    if seen.length < seen.tuning.swapped_frames:
        return
    names = [name for pair in EXCHANGED for name in pair] + [f"{shape}{side}" for shape in PULLING for side in _SIDES]
    part = slice(None, None, 1 + seen.length // _TELLING)
    agreement = judge({name: seen.weights[part, SHAPE_INDEX[name]] for name in names}, seen.kept[part]).agreement
    if agreement is not None and -agreement > seen.tuning.swapped:
        text = f"Left and right of the mouth look exchanged (correlation {agreement:+.2f})."
        weight = weight_of(-agreement, seen.tuning.swapped, seen.tuning.full_swapped)
        yield Flag("swapped", 0, seen.length, weight, text)


def unlike(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield frames on which the mouth is further from the mean face than any mouth that was recorded, by a factor.

    The distance is that of the learned prior (`engine/likeness.py`); where that is missing, nothing is flagged.
    """
    try:
        known = recorded()
    except AssetError:
        return
    limit = seen.tuning.unlike_times * known.furthest
    distance = np.where(seen.kept[low:high], known.distance(seen.controls[low:high]), 0.0)
    for start, stop in runs(distance > limit):
        most = float(distance[start:stop].max())
        text = (
            f"The mouth is further from its mean pose than all {counted(len(known.distances), 'recorded face')}, "
            f"{most / known.furthest:.1f} times as far as the furthest."
        )
        weight = weight_of(most / known.furthest, seen.tuning.unlike_times, seen.tuning.full_unlike_times)
        yield Flag("unlike", low + start, low + stop, weight, text)


def crossing(seen: Seen, low: int, high: int) -> Iterator[Flag]:
    """Yield frames on which the lips or the lids of the bundled head pass through each other."""
    for name, through_mm in (("lip", seen.tuning.through_lips_mm), ("lid", seen.tuning.through_lids_mm)):

        def verdict(weights: Array, kept: Mask, name: str = name) -> Array:
            return np.asarray(np.where(kept, crossed_mm(weights, name), 0.0))

        depth = strengths(seen, low, high, reach=0, verdict=verdict)
        for start, stop in runs(depth > through_mm):
            most = float(depth[start:stop].max())
            text = f"The {name}s pass through each other by {most:.1f} mm on the head."
            yield Flag(
                "through", low + start, low + stop, weight_of(most, through_mm, seen.tuning.full_through_mm), text
            )


def crossed_mm(weights: Array, name: str) -> Array:
    """Return by how much the lower lip or lid is above the upper one, (frames,) mm, negative where it is below."""
    rest, basis = _gaps(name)
    drawn = limited(weights)
    # einsum sums a row alike wherever it stands; a matrix product does not, and flags must not depend on that
    return np.asarray(
        -np.min([np.einsum("fs,s->f", drawn, row) + gap for gap, row in zip(rest, basis, strict=True)], 0)
    )


@lru_cache(maxsize=2)
def _gaps(name: str) -> tuple[Array, Array]:
    """Return the height of the upper over the lower landmark at rest, (pairs,) mm, and by weight, (pairs, 52)."""
    pairs = [pair for kind, *pair in _MEETING if kind == name]
    upper, up = bundled().landmark_positions([pair[0] for pair in pairs])
    lower, down = bundled().landmark_positions([pair[1] for pair in pairs])
    return upper[:, 1] - lower[:, 1], np.ascontiguousarray((up - down)[:, :, 1].T)
