"""What cleaning learns from: streams of performances that a simulated tracker has spoilt (BSS20b section 3.2)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import torch
from torch import Tensor

from engine.lab.corpus import Piece
from engine.lab.performer.augment import LOWER, Levers, augment
from engine.lab.performer.corpus import synthetic_performances
from engine.lab.performer.degrade import Faults, changing_times, degrade, scaled
from engine.lab.train.clean.material import CHANGING, cubic
from engine.take import MODEL_FPS, Array

RATES_FPS = (24.0, 30.0, 60.0, 120.0, CHANGING)


@dataclass(frozen=True)
class Settings:
    """What a training run depends on; the paper's values unless its place says otherwise."""

    seed: int = 0
    epochs: int = 40  # the learning rate falls to nothing by the last
    batches: int = 4  # to an epoch; every batch is spoilt anew
    chunk: int = 200
    first_chunk: int = 50  # for the first two thirds of the epochs: four times the steps, with a short memory
    chunks: int = 4  # consecutive chunks of one stream, the state handed on: a live stream does not begin anew
    streams: int = 64
    rate: float = 1e-3
    dropout: float = 0.0  # the paper's is 0.3; here every batch is spoilt anew, which keeps from overfitting too
    derivative_share: float = 0.002  # per (weight / s)^2; at the paper's 0.01 it outweighs the error
    distance_share: float = 0.004  # per cm; the paper's 0.1 would drown the rest
    input_distance_share: float = 0.8
    synthetic_minutes: float = 8.0
    lost_share: float = 0.25  # of the loss on lost frames, whose luck would otherwise drown what can be learnt
    ridge: float = 1e-3
    mouth_share: float = 0.3  # weight of takes that animate the mouth alone
    strengths: tuple[float, float] = (0.2, 2.0)
    faults: Faults = field(default_factory=lambda: Faults(amplitude=0.85))  # the most that may be made up
    levers: Levers = field(default_factory=lambda: Levers(copies=4))


class Batch(NamedTuple):
    """Spoilt streams and what they were: (streams, frames, 52), (streams, frames, 1) each for present and step_s."""

    truth: Tensor
    seen: Tensor
    present: Tensor
    step_s: Tensor


def stream(piece: Array, fps: float, frames: int, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return weights, (frames, 52), and times of a random stretch of a piece at a rate; short pieces run to and fro."""
    fastest = 120.0
    times = np.arange(frames) / fps if fps else changing_times(frames / 24.0, rng)[:frames]
    times = times if len(times) == frames else np.arange(frames) / fastest
    there_and_back = np.concatenate([piece, piece[::-1]])
    at = (times * MODEL_FPS + rng.uniform(0, len(there_and_back))) % (len(there_and_back) - 1)
    return np.clip(cubic(there_and_back, at), 0.0, 1.0), times


def make_batch(pieces: list[Array], settings: Settings, rng: np.random.Generator) -> Batch:
    """Draw pieces in proportion to their length, each at a random rate and strength of faults.

    Pieces that animate the mouth alone count less: most of a face's shapes have nothing to learn from them.
    """
    whole = np.array([piece[:, ~LOWER].any() for piece in pieces])
    lengths = np.array([len(piece) for piece in pieces]) * np.where(whole, 1.0, settings.mouth_share)
    frames = settings.chunk * settings.chunks
    columns: list[tuple[npt.NDArray[Any], ...]] = []
    for index in rng.choice(len(pieces), settings.streams, p=lengths / lengths.sum()):
        truth, times = stream(pieces[index], RATES_FPS[int(rng.integers(len(RATES_FPS)))], frames, rng)
        tracked = degrade(truth, times, scaled(settings.faults, rng.uniform(*settings.strengths)), rng)
        steps = np.diff(times, prepend=2 * times[0] - times[1])
        columns.append((truth, tracked.weights, 1.0 - tracked.lost[:, None], steps[:, None]))
    return Batch(*(torch.tensor(np.stack(column), dtype=torch.float32) for column in zip(*columns, strict=True)))


def training_pieces(pieces: list[Piece], settings: Settings) -> list[Array]:
    """Return augmented recorded pieces and synthetic performances."""
    rng = np.random.default_rng(settings.seed)
    real = augment([piece.weights for piece in pieces], settings.levers, rng)
    return real + synthetic_performances(settings.synthetic_minutes, seed=settings.seed)
