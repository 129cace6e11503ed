"""Faults planted into excerpts of recorded takes, one of each kind of flag at a time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from engine.anatomy import pairs
from engine.controls import CONTROL_INDEX
from engine.formats.livelink.sides import exchange, judge
from engine.lab.evaluate.flags import plants_mouth
from engine.lab.evaluate.flags.planting import EDGE_S, Plant, Planted, free_range, with_rows
from engine.quality import TUNING, Seen
from engine.quality.seen import LIDS, drops
from engine.take import SHAPE_INDEX, SHAPES

LIPS = CONTROL_INDEX["lips_vertical"]
STEADY = [
    i for i, name in enumerate(SHAPES) if name.startswith(("mouth", "brow", "cheek", "nose")) and name != "mouthClose"
]


def _lost(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = free_range(seen, rng, 0.05, 1.0)
    if place is None:
        return None
    lost = seen.lost.copy()
    lost[slice(*place)] = True
    return Planted(replace(seen, lost=lost), *place)


def _spike(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = free_range(seen, rng, 0.0, 0.0)
    if place is None:
        return None
    weights = seen.weights.copy()
    shapes = rng.choice(STEADY, rng.integers(1, 6), replace=False)
    row = weights[place[0], shapes]
    weights[place[0], shapes] = row + np.where(row > 0.5, -1, 1) * rng.uniform(0.12, 0.5)
    return Planted(with_rows(seen, weights), *place)


def _frozen(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = free_range(seen, rng, 0.12, 0.5)
    if place is None or not seen.weights[place[0] - 1].any():
        return None
    weights = seen.weights.copy()
    weights[slice(*place)] = weights[place[0] - 1]
    return Planted(with_rows(seen, weights), *place)


def _jitter(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = free_range(seen, rng, 1.0, 3.0)
    if place is None:
        return None
    weights = seen.weights.copy()
    shapes = rng.choice(STEADY, rng.integers(2, 10), replace=False)
    noise = rng.standard_normal((place[1] - place[0], len(shapes))) * rng.uniform(0.015, 0.1)
    rows = weights[slice(*place), shapes] + noise
    weights[slice(*place), shapes] = np.clip(rows + 0.1, 0.0, 1.0)
    return Planted(with_rows(seen, weights), *place)


def _pop(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = free_range(seen, rng, 0.5, 3.0)
    if place is None:
        return None
    weights = seen.weights.copy()
    shapes = rng.choice(STEADY, rng.integers(1, 4), replace=False)
    step = rng.uniform(0.15, 0.6) * np.where(weights[place[0] : place[1], shapes].mean(axis=0) > 0.5, -1, 1)
    weights[slice(*place), shapes] = np.clip(weights[slice(*place), shapes] + step, 0.0, 1.0)
    return Planted(with_rows(seen, weights), *place)


def _head(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = free_range(seen, rng, 0.0, 0.0)
    if place is None:
        return None
    assert seen.rotations is not None
    turned = seen.rotations.copy()
    axis = int(rng.integers(3))
    turned[place[0] :, axis] += np.radians(rng.uniform(4, 25)) * rng.choice([-1, 1])
    return Planted(replace(seen, rotations=turned), place[0], place[0] + 1)


def _impossible(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = free_range(seen, rng, 0.2, 1.0)
    if place is None:
        return None
    weights = seen.weights.copy()
    first, second, _ = pairs()[int(rng.integers(len(pairs())))]
    for shape in (first, second):
        weights[slice(*place), shape] = np.maximum(weights[slice(*place), shape], rng.uniform(0.5, 0.95))
    return Planted(with_rows(seen, weights), *place)


def _out_of_range(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = free_range(seen, rng, 0.1, 1.0)
    if place is None:
        return None
    weights = seen.weights.copy()
    weights[slice(*place), int(rng.choice(STEADY))] = (
        rng.uniform(1.06, 1.5) if rng.random() < 0.5 else -rng.uniform(0.03, 0.3)
    )
    return Planted(with_rows(seen, weights), *place)


def _swapped(seen: Seen, rng: np.random.Generator) -> Planted | None:
    """Exchange the sides of a mouth that does go to one side."""
    curves = {name: seen.weights[:, SHAPE_INDEX[name]] for name in SHAPES}
    if judge(curves, seen.kept).agreement is None:
        return None
    return Planted(with_rows(seen, exchange(seen.weights)), 0, seen.length)


def _blink(seen: Seen, rng: np.random.Generator) -> tuple[int, int, int] | None:
    """Return the bottom of a blink that closes, and the range around it."""
    within = seen.frames(TUNING.blink_within_s)
    both = [(drops(seen.controls[:, c], within) > 4.0) & (seen.controls[:, c] < 1.5) for c in LIDS.values()]
    margin, edge = seen.frames(0.3), seen.frames(EDGE_S)
    at = [f for f in np.flatnonzero(both[0] & both[1]) if edge < f < seen.length - edge]
    at = [f for f in at if not seen.lost[f - margin : f + margin].any()]
    if not at:
        return None
    frame = int(at[int(rng.integers(len(at)))])
    return frame, frame - margin, frame + margin + 1


def _unclosed(seen: Seen, rng: np.random.Generator) -> Planted | None:
    found = _blink(seen, rng)
    if found is None:
        return None
    at, first, last = found
    away = np.abs(np.arange(first, last) - at) / max(1, at - first)
    window = 0.5 + 0.5 * np.cos(np.pi * away)
    least, edited = rng.uniform(3.5, 5.0), rng.random() < 0.5
    for share in np.linspace(0.9, 0.2, 25):
        weights = seen.weights.copy()
        for side in LIDS:
            weights[first:last, SHAPE_INDEX[f"eyeBlink{side}"]] *= 1 - (1 - share) * window
        weak = with_rows(seen, weights)
        gap = weak.controls[at - 2 : at + 3, list(LIDS.values())].min()
        if gap > least:
            if edited:
                weak = replace(weak, original_weights=seen.weights, original_controls=seen.controls)
            return Planted(weak, at - 2, at + 3)
    return None


def _late(seen: Seen, rng: np.random.Generator) -> Planted | None:
    found = _blink(seen, rng)
    if found is None:
        return None
    at, first, last = found
    shift = max(2, round(rng.uniform(0.06, 0.25) * seen.fps))
    side = str(rng.choice(list(LIDS)))
    column = SHAPE_INDEX[f"eyeBlink{side}"]
    stop = min(seen.length, last + shift)
    weights = seen.weights.copy()
    weights[first + shift : stop, column] = seen.weights[first : stop - shift, column]
    weights[first : first + shift, column] = seen.weights[first, column]
    return Planted(with_rows(seen, weights), at - 1, at + shift + 2)


def _unblinking(seen: Seen, rng: np.random.Generator) -> Planted | None:
    length = round(rng.uniform(30.0, 45.0) * seen.fps)
    within = seen.frames(TUNING.blink_within_s)
    if seen.length < length or seen.lost.any() or (drops(seen.controls[:, LIDS["Left"]], within) > 4.0).sum() < 3:
        return None
    start = int(rng.integers(0, seen.length - length + 1))
    weights, here = seen.weights.copy(), slice(start, start + length)
    for side in LIDS:
        lid = weights[here, SHAPE_INDEX[f"eyeBlink{side}"]]
        weights[here, SHAPE_INDEX[f"eyeBlink{side}"]] = np.minimum(lid, np.percentile(lid, 20)) + 0.05 * lid
    return Planted(with_rows(seen, weights), start, start + length)


def _missed(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = free_range(seen, rng, 0.2, 1.0)
    if place is None:
        return None
    asked = np.full_like(seen.controls, np.nan)
    asked[:, LIPS] = seen.controls[:, LIPS]  # everywhere else it is reached
    asked[slice(*place), LIPS] += rng.uniform(2.0, 8.0)
    return Planted(replace(seen, asked=asked), *place)


def _seam(seen: Seen, rng: np.random.Generator) -> Planted | None:
    """Lay an offset with hard borders over one range, and one with eased borders over another, as a control."""
    place, eased = free_range(seen, rng, 0.4, 1.5), free_range(seen, rng, 1.0, 1.5)
    if place is None or eased is None or abs(place[0] - eased[0]) < 3 * seen.fps:
        return None
    weights = seen.weights.copy()
    shapes = rng.choice(STEADY, rng.integers(1, 5), replace=False)
    weights[slice(*place), shapes] += rng.uniform(0.06, 0.4)
    bump = np.sin(np.linspace(0, np.pi, eased[1] - eased[0])) ** 2
    weights[slice(*eased), shapes] += 0.3 * bump[:, None]
    weights = np.minimum(weights, 1.0)
    edited = replace(with_rows(seen, weights), original_weights=seen.weights, original_controls=seen.controls)
    return Planted(edited, *place)


def _short(seen: Seen, rng: np.random.Generator) -> Planted | None:
    if seen.sound is None:
        return None
    stop = seen.length - round(rng.uniform(0.3, 2.0) * seen.fps)
    cut = replace(seen, weights=seen.weights[:stop], controls=seen.controls[:stop], lost=seen.lost[:stop])
    if cut.rotations is not None:
        cut = replace(cut, rotations=cut.rotations[:stop])
    return Planted(cut, stop - 1, stop)


def _out_of_step(seen: Seen, rng: np.random.Generator) -> Planted | None:
    if seen.sound is None:
        return None
    by = round(rng.uniform(0.1, 0.5) * seen.fps) * int(rng.choice([-1, 1]))
    return Planted(with_rows(seen, np.roll(seen.weights, by, axis=0)), 0, seen.length)


PLANTS: dict[str, Plant] = {
    "lost": _lost,
    "spike": _spike,
    "frozen": _frozen,
    "jitter": _jitter,
    "pop": _pop,
    "head": _head,
    "impossible": _impossible,
    "unlike": plants_mouth.unlike,
    "range": _out_of_range,
    "through": plants_mouth.through,
    "swapped": _swapped,
    "open": plants_mouth.parted("M", 1.0, TUNING.closed_mm),
    "teeth": plants_mouth.parted("F", 4.0, TUNING.teeth_mm),
    "close": plants_mouth.close,
    "unclosed": _unclosed,
    "late": _late,
    "unblinking": _unblinking,
    "missed": _missed,
    "seam": _seam,
    "short": _short,
    "sound": _out_of_step,
}
