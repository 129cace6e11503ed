"""Takes to look at: one with every fault, one with none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from engine.controls import CONTROL_INDEX
from engine.extended import bundled_face
from engine.quality import KINDS, FlagSettings, Seen, flags_of
from engine.speech.lane import attached
from engine.speech.visemes import Cue
from engine.take import SHAPE_INDEX, SHAPES, Array

FPS = 30.0
measure = bundled_face().measure
EVERY = FlagSettings(counts={name: True for name in KINDS})
SAID = ["M", "AA1", "B", "P", "IY", "M", "V", "B", "F", "M", "P", "B"]
STEADY = [i for i, name in enumerate(SHAPES) if name.startswith(("brow", "cheek", "nose"))]
CLOSED_FACE = {"jawOpen": 0.0, "mouthClose": 0.3, "mouthShrugLower": 1.0, "mouthRollUpper": 1.0}
CLOSED = [SHAPE_INDEX[name] for name in CLOSED_FACE]
LIPS, JAW = CONTROL_INDEX["lips_vertical"], SHAPE_INDEX["jawOpen"]


def troubled(seed: int, frames: int = 420) -> Seen:
    """A slow random performance with every fault in it."""
    rng = np.random.default_rng(seed)
    knots = rng.random((frames // 12 + 2, len(SHAPES))) * rng.random(len(SHAPES))
    at = np.linspace(0, len(knots) - 1.001, frames)
    low = at.astype(int)
    weights = knots[low] + (at - low)[:, None] * (knots[low + 1] - knots[low])
    weights[rng.integers(1, frames - 1, 4), rng.integers(0, len(SHAPES), 4)] += 0.5
    weights[rng.integers(1, frames) :, int(rng.choice(STEADY))] += 0.4
    begin = int(rng.integers(0, frames - 40))
    weights[begin : begin + 40, SHAPE_INDEX["browInnerUp"]] += rng.normal(0, 0.1, 40)
    weights[60:70] = 0.0
    weights[60:70, CLOSED] = list(CLOSED_FACE.values())
    put_blinks(weights, rng)
    for start in rng.integers(0, frames - 9, 3):
        weights[start : start + rng.integers(2, 8)] = weights[start]
    lost = np.zeros(frames, bool)
    lost[frames // 2 : frames // 2 + 5] = True
    before = weights.copy()
    before[100:160] = np.clip(weights[100:160] - rng.random((60, len(SHAPES))) * 0.4, 0, 1)
    original = measure(np.clip(weights - rng.random(weights.shape) * 0.4, 0, 1))
    cues = [Cue(start, start + 0.1, label) for start, label in zip(rng.random(12) * 14, SAID, strict=True)]
    turned = np.cumsum(rng.normal(0, 0.01, (frames, 3)), axis=0)
    turned[rng.integers(5, frames) :, 1] += 0.4
    seen = Seen(weights, measure(weights), FPS, lost, None, original, attached(cues, "t"), before, turned)
    return with_weights(seen, weights)


def put_blinks(weights: Array, rng: np.random.Generator) -> None:
    """Put in blinks: most close, some do not, some with one eye late; between them the lids are at rest."""
    weights[:, [i for i, name in enumerate(SHAPES) if name.startswith("eye")]] = 0.0
    for number, start in enumerate(range(10, len(weights) - 20, 40)):
        late = 4 if number == 3 else 0
        size = 0.5 if number == 7 else 1.0
        for side, shift in (("Left", 0), ("Right", late)):
            weights[start + shift : start + shift + 5, SHAPE_INDEX[f"eyeBlink{side}"]] = size * np.sin(
                np.linspace(0, np.pi, 5)
            )


def with_weights(seen: Seen, weights: Array) -> Seen:
    controls = measure(weights)
    wave = np.sin(np.arange(controls.shape[1])) * 4
    asked = np.where(np.arange(len(weights))[:, None] % 40 < 9, controls + wave, np.nan)
    return replace(seen, weights=weights, controls=controls, asked=asked)


def still(frames: int = 300) -> Array:
    """A face that moves a little, smoothly and alike on both sides, as no tracker fault does."""
    time_s = np.arange(frames) / FPS
    return 0.3 + 0.05 * np.sin(2 * np.pi * 0.7 * time_s)[:, None] * np.ones(len(SHAPES))


def looked(weights: Array, **more: object) -> Seen:
    return replace(Seen(weights, measure(weights), FPS, np.zeros(len(weights), bool)), **more)


def found(seen: Seen, kind: str) -> list[tuple[int, int]]:
    return [(flag.start, flag.stop) for flag in flags_of(seen, EVERY) if flag.kind == kind]


def spoken(frames: int) -> tuple[Array, Array]:
    """A mouth that opens and closes at random, and how loud that is."""
    rng = np.random.default_rng(1)
    opening = np.clip(np.convolve(rng.normal(0, 1, frames + 8), np.ones(9) / 5, "valid"), 0, 1)
    weights = still(frames)
    weights[:, JAW] = 0.5 * opening
    return weights, opening
