"""Training material: performances by the window, with random holes and random help, as BSS20 section 3.1 trains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from engine.controls import CONTROLS, bundled_measurer
from engine.inpaint.gap import Gap, gap_of
from engine.inpaint.regions import REGIONS
from engine.lab.corpus import Piece, whole_faces
from engine.lab.performer.augment import LOWER, Levers, augment
from engine.lab.performer.corpus import random_script
from engine.lab.performer.performer import perform, phones
from engine.lab.speech import allphone
from engine.lab.speech.lipread import read_lips
from engine.speech.visemes import Cue, classes_over, one_hot
from engine.take import MODEL_FPS, SHAPES, Array, Mask

SHORTEST = 48  # frames; a shorter piece has no room for a hole and its context


@dataclass(frozen=True, eq=False)
class Performance:
    """A whole face with the viseme class of each frame.

    Attributes
    ----------
    weights : (frames, 52) in 0..1 at the model rate
    visemes : (frames,) int, −1 where unknown
    rest : (frames, 52) each, what comes before and after in the same take, where it is a window of one
    """

    weights: Array
    visemes: np.ndarray
    rest: Sequence[Array] = ()


@dataclass(frozen=True)
class Help:
    """How often a hole comes with which kind of guidance, and how it is drawn."""

    unguided: float = 0.3
    pins: float = 0.35
    guide: float = 0.25
    visemes: float = 0.35
    controls: float = 0.35
    all_controls: float = 0.5
    longest_pin_gap_s: float = 0.8
    levers: Levers = field(default_factory=Levers)
    synthetic_minutes: float = 12.0
    read_lips: bool = True
    heard_copies: int = 2  # of each piece with sound, labelled by ear instead of by eye


def performances(
    pieces: Sequence[Piece], help_: Help, rng: np.random.Generator, heard: Mapping[str, Sequence[Cue]] | None = None
) -> list[Performance]:
    """Return recorded pieces with their variants, and synthetic performances.

    Pieces that animate the mouth alone are given the upper face of another take: half a face that never moves would
    teach the network that faces do not. `heard` are the phones of takes with sound, by their name.
    """
    faces = [piece.weights for piece in whole_faces(pieces)]
    recorded = [piece.weights if piece.whole_face else _completed(piece.weights, faces, rng) for piece in pieces]
    varied = augment([weights for weights in recorded if len(weights) >= SHORTEST], help_.levers, rng)
    result = [
        Performance(weights, read_lips(weights, fps=MODEL_FPS) if help_.read_lips else np.full(len(weights), -1))
        for weights in varied
    ]
    for piece, weights in zip(pieces, recorded, strict=True):
        if heard and piece.source in heard and len(weights) >= SHORTEST:
            result += [Performance(weights, said_in(piece, heard[piece.source]))] * help_.heard_copies
    return result + synthetic(help_.synthetic_minutes, rng)


def said_in(piece: Piece, cues: Sequence[Cue]) -> np.ndarray:
    """Return the viseme class of each frame of a piece, (frames,) int, by the cues of the take that it was cut from."""
    begin = piece.first / MODEL_FPS
    moved = [Cue(cue.start_s - begin, cue.stop_s - begin, cue.label) for cue in cues]
    return classes_over(moved, frames=len(piece.weights), fps=MODEL_FPS)


def listened(folder: Path) -> dict[str, list[Cue]]:
    """Return the phones heard in the sound beside takes below a folder, by name; none without PocketSphinx."""
    if not allphone.available():
        return {}
    return {path.stem: allphone.listen(path) for path in sorted(folder.rglob("*.wav"))}


def synthetic(minutes: float, rng: np.random.Generator) -> list[Performance]:
    """Return nonsense speech of the given length in all, labelled with the phones that were played."""
    result: list[Performance] = []
    while sum(len(performance.weights) for performance in result) < minutes * 60 * MODEL_FPS:
        script = random_script(rng)
        weights = perform(script).weights
        cues = [Cue(*phone) for phone in phones(script)]
        result.append(Performance(weights, classes_over(cues, frames=len(weights), fps=MODEL_FPS)))
    return result


def _completed(mouth: Array, faces: Sequence[Array], rng: np.random.Generator) -> Array:
    face = faces[int(rng.integers(len(faces)))]
    return np.asarray(np.where(LOWER, mouth, window(face, len(mouth), int(rng.integers(len(face))))))


def window(curves: Array, frames: int, start: int) -> Array:
    """Return a stretch of curves of a given length from `start` on, running to and fro where it is longer than they."""
    last = len(curves) - 1
    turn = np.abs((np.arange(start, start + frames) + last) % max(1, 2 * last) - last)
    return np.asarray(curves[turn])


def draw(material: Sequence[Performance], frames: int, rng: np.random.Generator) -> Performance:
    """Return a random window; every moment of the material is as likely."""
    lengths = np.array([len(performance.weights) for performance in material])
    performance = material[int(rng.choice(len(material), p=lengths / lengths.sum()))]
    room = len(performance.weights) - frames
    if room >= 0:
        start, stop = (begin := int(rng.integers(room + 1))), begin + frames
        return Performance(
            performance.weights[start:stop],
            performance.visemes[start:stop],
            (performance.weights[:start], performance.weights[stop:]),
        )
    start = int(rng.integers(len(performance.weights)))
    both = np.concatenate([performance.weights, performance.visemes[:, None]], axis=1)
    both = window(both, frames, start)
    return Performance(both[:, :-1], both[:, -1].astype(int))


def random_gap(truth: Performance, help_: Help, rng: np.random.Generator) -> Gap:
    """Return a window of truth with holes torn into it and a random subset of the guidance kinds."""
    frames = len(truth.weights)
    hole = random_hole(frames, rng)
    inside = np.asarray(hole.any(axis=1))
    guided = rng.random() > help_.unguided
    shown = {name: guided and rng.random() < getattr(help_, name) for name in ("pins", "guide", "visemes", "controls")}
    if inside.all() and not any(shown.values()):
        shown["controls"] = True
    known = np.where(hole, np.nan, truth.weights)
    if shown["pins"]:
        pins = random_pins(hole, help_.longest_pin_gap_s, rng)
        known[pins] = truth.weights[pins]
    guide = np.where(hole, roughened(truth.weights, rng), np.nan) if shown["guide"] else None
    present = one_hot(np.where(inside, truth.visemes, -1)) if shown["visemes"] else None
    return gap_of(
        known,
        guide=guide,
        visemes=present,
        controls=_some_controls(truth, inside, help_, rng) if shown["controls"] else None,
        rest=truth.rest,
    )


def random_hole(frames: int, rng: np.random.Generator) -> Mask:
    """Return (frames, 52) true where motion is to be made: one to three spans of one region, or everything."""
    hole = np.zeros((frames, len(SHAPES)), bool)
    region = REGIONS["face" if rng.random() < 0.6 else str(rng.choice(list(REGIONS)))]
    if rng.random() < 0.18:
        hole[:, region] = True
        return hole
    for _ in range(int(rng.choice([1, 2, 3], p=[0.5, 0.3, 0.2]))):
        longest = 0.8 * frames
        length = int(np.exp(rng.uniform(np.log(2), np.log(longest))) if rng.random() < 0.5 else rng.uniform(2, longest))
        start = int(rng.integers(-length // 4, frames - 3 * length // 4))
        hole[np.ix_(np.arange(max(0, start), min(frames, start + length)), np.flatnonzero(region))] = True
    return hole


def random_pins(hole: Mask, longest_gap_s: float, rng: np.random.Generator) -> Mask:
    """Return where truth is pinned: every so often as in the paper, or at a few frames; whole poses or some shapes."""
    inside = np.flatnonzero(hole.any(axis=1))
    if rng.random() < 0.5:
        steps = rng.integers(1, round(longest_gap_s * MODEL_FPS) + 1, len(inside))
        at = inside[np.unique(np.minimum(np.cumsum(steps) - 1, len(inside) - 1))]
    else:
        at = rng.choice(inside, min(len(inside), int(rng.integers(1, 4))), replace=False)
    pins = np.zeros_like(hole)
    pins[at] = hole[at]
    if rng.random() < 0.3:
        pins &= REGIONS[str(rng.choice(list(REGIONS)))] | (rng.random(len(SHAPES)) < 0.1)
    return pins


def roughened(weights: Array, rng: np.random.Generator) -> Array:
    """Return a performance as a poor tracker or a rough sketch would have it, in 0..1.

    Gains and offsets per shape, lag, blur, jitter and spikes; each of random strength.
    """
    frames = len(weights)
    rough = weights * np.exp(0.3 * rng.random() * rng.standard_normal(len(SHAPES)))
    lag = int(rng.integers(-2, 3))
    rough = rough[np.clip(np.arange(frames) - lag, 0, frames - 1)]
    for _ in range(int(rng.integers(0, 4))):  # each pass is a binomial blur of one frame to either side
        rough = np.concatenate([rough[:1], (rough[:-2] + 2 * rough[1:-1] + rough[2:]) / 4, rough[-1:]])
    spread = rng.uniform(0.0, 0.08) * (0.2 + np.sqrt(weights.var(axis=0)) * 4)
    rough = rough + spread * rng.standard_normal(rough.shape)
    spikes = rng.random(rough.shape) < rng.uniform(0.0, 0.01)
    return np.asarray(np.clip(np.where(spikes, rng.random(rough.shape), rough), 0.0, 1.0))


def _some_controls(truth: Performance, inside: Mask, help_: Help, rng: np.random.Generator) -> Array:
    asked = np.ones(len(CONTROLS), bool)
    if rng.random() > help_.all_controls:
        asked = rng.random(len(CONTROLS)) < rng.uniform(0.1, 0.7)
        asked[int(rng.integers(len(CONTROLS)))] = True
    return np.where(inside[:, None] & asked, bundled_measurer().measure(truth.weights), np.nan)
