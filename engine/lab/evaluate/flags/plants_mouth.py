"""Faults of the mouth: driven too hard, lips through each other, apart where they should meet, closed too far."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from engine.controls import CONTROL_INDEX
from engine.lab.evaluate.flags.planting import EDGE_S, Plant, Planted, free_range, with_rows
from engine.quality import Seen
from engine.quality.seen import LIDS
from engine.quality.shape import crossed_mm
from engine.speech.lane import VisemeLane, attached
from engine.speech.visemes import Cue
from engine.take import SHAPE_INDEX, SHAPES, runs

LIPS, JAW, CLOSE = CONTROL_INDEX["lips_vertical"], SHAPE_INDEX["jawOpen"], SHAPE_INDEX["mouthClose"]
CUE_S = 0.12
_MOUTH = np.array([i for i, name in enumerate(SHAPES) if name.startswith(("mouth", "jaw"))])


def unlike(seen: Seen, rng: np.random.Generator) -> Planted | None:
    """Drive the mouth too hard: several times what it does there, or shapes that nobody combines."""
    place = free_range(seen, rng, 0.3, 1.0)
    if place is None:
        return None
    weights, here = seen.weights.copy(), slice(*place)
    rows = weights[here][:, _MOUTH]
    eased = np.sin(np.linspace(0, np.pi, len(rows)))[:, None] ** 0.5
    if rng.random() < 0.5:
        driven = rows * (1 + eased * rng.uniform(2.0, 5.0))
        if driven.max() < 1.0 or (driven.max(axis=0) > 0.5).sum() < 4:
            return None  # nothing is said there that could be overdone
    else:
        goal = np.zeros(len(_MOUTH))
        goal[rng.choice(len(_MOUTH), rng.integers(5, 9), replace=False)] = rng.uniform(0.7, 1.0)
        driven = rows * (1 - eased) + goal * eased
    weights[here, _MOUTH] = np.clip(driven, 0.0, 1.0)
    return Planted(with_rows(seen, weights), *place)


def through(seen: Seen, rng: np.random.Generator) -> Planted | None:
    """Push one lip over the other with the jaw shut, or both lids past each other, by a share of what shapes can do."""
    place = free_range(seen, rng, 0.2, 1.0)
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


def parted(label: str, within_mm: float, least_mm: float) -> Plant:
    """Return what parts lips that come within a distance, by half as much again as a flag's threshold, under a label."""

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


def close(seen: Seen, rng: np.random.Generator) -> Planted | None:
    """Close the lips further than the jaw has opened."""
    place = free_range(seen, rng, 0.1, 1.0)
    if place is None:
        return None
    weights, here = seen.weights.copy(), slice(*place)
    weights[here, CLOSE] = np.minimum(weights[here, JAW] + rng.uniform(0.1, 0.5), 1.0)
    if (weights[here, CLOSE] - weights[here, JAW]).max() < 0.09:
        return None
    return Planted(with_rows(seen, weights), *place)
