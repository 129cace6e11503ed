"""Faults planted into excerpts of recorded takes, one of each kind of flag at a time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from engine.anatomy import pairs
from engine.controls import CONTROL_INDEX, measure
from engine.formats.livelink.sides import exchange, judge
from engine.quality import TUNING, Seen
from engine.quality.seen import LIDS, drops
from engine.quality.shape import crossed_mm
from engine.speech.lane import VisemeLane, attached
from engine.speech.visemes import Cue
from engine.take import SHAPE_INDEX, SHAPES, Array, runs

LIPS, JAW, CLOSE = CONTROL_INDEX["lips_vertical"], SHAPE_INDEX["jawOpen"], SHAPE_INDEX["mouthClose"]
STEADY = [
    i for i, name in enumerate(SHAPES) if name.startswith(("mouth", "brow", "cheek", "nose")) and name != "mouthClose"
]
EDGE_S = 1.0  # nothing is planted nearer to the ends of an excerpt
CUE_S = 0.12


@dataclass(frozen=True, eq=False)
class Planted:
    """An excerpt with a fault on the frames start to stop (half-open)."""

    seen: Seen
    start: int
    stop: int


# Puts a fault into an excerpt; None where this one gives no occasion for it.
Plant = Callable[[Seen, np.random.Generator], Planted | None]


def with_rows(seen: Seen, weights: Array) -> Seen:
    """Return the same excerpt with other weights, (frames, 52), measured anew."""
    return replace(seen, weights=weights, controls=measure(weights))


def _range(seen: Seen, rng: np.random.Generator, least_s: float, most_s: float) -> tuple[int, int] | None:
    """Return a random range without lost frames."""
    edge = seen.frames(EDGE_S)
    for _ in range(50):
        length = max(1, round(rng.uniform(least_s, most_s) * seen.fps))
        if seen.length - 2 * edge <= length:
            return None
        start = int(rng.integers(edge, seen.length - edge - length))
        if not seen.lost[start - 3 : start + length + 3].any():
            return start, start + length
    return None


def _lost(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = _range(seen, rng, 0.05, 1.0)
    if place is None:
        return None
    lost = seen.lost.copy()
    lost[slice(*place)] = True
    return Planted(replace(seen, lost=lost), *place)


def _spike(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = _range(seen, rng, 0.0, 0.0)
    if place is None:
        return None
    weights = seen.weights.copy()
    shapes = rng.choice(STEADY, rng.integers(1, 6), replace=False)
    row = weights[place[0], shapes]
    weights[place[0], shapes] = row + np.where(row > 0.5, -1, 1) * rng.uniform(0.12, 0.5)
    return Planted(with_rows(seen, weights), *place)


def _frozen(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = _range(seen, rng, 0.12, 0.5)
    if place is None or not seen.weights[place[0] - 1].any():
        return None
    weights = seen.weights.copy()
    weights[slice(*place)] = weights[place[0] - 1]
    return Planted(with_rows(seen, weights), *place)


def _jitter(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = _range(seen, rng, 1.0, 3.0)
    if place is None:
        return None
    weights = seen.weights.copy()
    shapes = rng.choice(STEADY, rng.integers(2, 10), replace=False)
    noise = rng.standard_normal((place[1] - place[0], len(shapes))) * rng.uniform(0.015, 0.1)
    rows = weights[slice(*place), shapes] + noise
    weights[slice(*place), shapes] = np.clip(rows + 0.1, 0.0, 1.0)
    return Planted(with_rows(seen, weights), *place)


def _pop(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = _range(seen, rng, 0.5, 3.0)
    if place is None:
        return None
    weights = seen.weights.copy()
    shapes = rng.choice(STEADY, rng.integers(1, 4), replace=False)
    step = rng.uniform(0.15, 0.6) * np.where(weights[place[0] : place[1], shapes].mean(axis=0) > 0.5, -1, 1)
    weights[slice(*place), shapes] = np.clip(weights[slice(*place), shapes] + step, 0.0, 1.0)
    return Planted(with_rows(seen, weights), *place)


def _head(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = _range(seen, rng, 0.0, 0.0)
    if place is None:
        return None
    assert seen.rotations is not None
    turned = seen.rotations.copy()
    axis = int(rng.integers(3))
    turned[place[0] :, axis] += np.radians(rng.uniform(4, 25)) * rng.choice([-1, 1])
    return Planted(replace(seen, rotations=turned), place[0], place[0] + 1)


def _impossible(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = _range(seen, rng, 0.2, 1.0)
    if place is None:
        return None
    weights = seen.weights.copy()
    first, second, _ = pairs()[int(rng.integers(len(pairs())))]
    for shape in (first, second):
        weights[slice(*place), shape] = np.maximum(weights[slice(*place), shape], rng.uniform(0.5, 0.95))
    return Planted(with_rows(seen, weights), *place)


def _out_of_range(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = _range(seen, rng, 0.1, 1.0)
    if place is None:
        return None
    weights = seen.weights.copy()
    weights[slice(*place), int(rng.choice(STEADY))] = (
        rng.uniform(1.06, 1.5) if rng.random() < 0.5 else -rng.uniform(0.03, 0.3)
    )
    return Planted(with_rows(seen, weights), *place)


def _through(seen: Seen, rng: np.random.Generator) -> Planted | None:
    """Push one lip over the other with the jaw shut, or both lids past each other, by a share of what shapes can do."""
    place = _range(seen, rng, 0.2, 1.0)
    if place is None:
        return None
    weights, here = seen.weights.copy(), slice(*place)
    amount = rng.uniform(0.6, 1.0)
    if rng.random() < 0.7:
        weights[here, JAW] = weights[here, CLOSE] = 0.0
        for name in ("mouthShrugLower", "mouthRollUpper", "mouthPressLeft", "mouthPressRight"):
            weights[here, SHAPE_INDEX[name]] = amount
        if crossed_mm(weights[here], "lip").max() < 1.0:
            return None
    else:
        for name in ("eyeBlink", "eyeSquint", "eyeLookDown"):
            for side in LIDS:
                weights[here, SHAPE_INDEX[name + side]] = 0.5 + amount / 2
        if crossed_mm(weights[here], "lid").max() < 5.0:
            return None
    return Planted(with_rows(seen, weights), *place)


def _swapped(seen: Seen, rng: np.random.Generator) -> Planted | None:
    """Exchange the sides of a mouth that does go to one side."""
    curves = {name: seen.weights[:, SHAPE_INDEX[name]] for name in SHAPES}
    if judge(curves, seen.kept).agreement is None:
        return None
    return Planted(with_rows(seen, exchange(seen.weights)), 0, seen.length)


def _cues(seen: Seen, label: str, within_mm: float) -> tuple[VisemeLane, list[tuple[int, int]]] | None:
    """Return cues where the lips come as near as a sound needs, which are what is said there as far as flags know."""
    near = [
        run
        for run in runs(seen.controls[:, LIPS] < within_mm)
        if run[1] - run[0] < seen.frames(0.4) and not seen.lost[slice(*run)].any()
    ]
    near = [run for run in near if seen.frames(EDGE_S) < run[0] < seen.length - seen.frames(EDGE_S)]
    if not near:
        return None
    cues = []
    for start, stop in near:
        middle = (start + stop) / 2 / seen.fps
        cues.append(Cue(middle - CUE_S / 2, middle + CUE_S / 2, label))
    return attached(cues, "planted"), near


def _parted(label: str, within_mm: float, least_mm: float) -> Plant:
    def plant(seen: Seen, rng: np.random.Generator) -> Planted | None:
        """Open the jaw over one of the places where the lips do come near."""
        found = _cues(seen, label, within_mm)
        if found is None:
            return None
        lane, near = found
        start, stop = near[int(rng.integers(len(near)))]
        margin = seen.frames(0.15)
        first, last = max(0, start - margin), min(seen.length, stop + margin)
        bump = np.sin(np.linspace(0, np.pi, last - first)) ** 0.5
        for size in np.linspace(0.1, 1.0, 19) * rng.uniform(0.8, 1.2):
            weights = seen.weights.copy()
            weights[first:last, JAW] = np.minimum(weights[first:last, JAW] + size * bump, 1.0)
            weights[first:last, CLOSE] *= 1 - bump
            opened = with_rows(seen, weights)
            if opened.controls[start - 1 : stop + 1, LIPS].min() > least_mm * 1.5:
                return Planted(replace(opened, visemes=lane), start - 2, stop + 2)
        return None

    return plant


def _close(seen: Seen, rng: np.random.Generator) -> Planted | None:
    place = _range(seen, rng, 0.1, 1.0)
    if place is None:
        return None
    weights, here = seen.weights.copy(), slice(*place)
    weights[here, CLOSE] = np.minimum(weights[here, JAW] + rng.uniform(0.1, 0.5), 1.0)
    if (weights[here, CLOSE] - weights[here, JAW]).max() < 0.09:
        return None
    return Planted(with_rows(seen, weights), *place)


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
    place = _range(seen, rng, 0.2, 1.0)
    if place is None:
        return None
    asked = np.full_like(seen.controls, np.nan)
    asked[:, LIPS] = seen.controls[:, LIPS]  # everywhere else it is reached
    asked[slice(*place), LIPS] += rng.uniform(2.0, 8.0)
    return Planted(replace(seen, asked=asked), *place)


def _seam(seen: Seen, rng: np.random.Generator) -> Planted | None:
    """Lay an offset with hard borders over one range, and one with eased borders over another, as a control."""
    place, eased = _range(seen, rng, 0.4, 1.5), _range(seen, rng, 1.0, 1.5)
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
    "range": _out_of_range,
    "through": _through,
    "swapped": _swapped,
    "open": _parted("M", 1.0, TUNING.closed_mm),
    "teeth": _parted("F", 4.0, TUNING.teeth_mm),
    "close": _close,
    "unclosed": _unclosed,
    "late": _late,
    "unblinking": _unblinking,
    "missed": _missed,
    "seam": _seam,
    "short": _short,
    "sound": _out_of_step,
}
