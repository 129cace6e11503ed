"""Whether the lips of a take meet where M, B or P is said: what tells sound that belongs to a take from other sound."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engine.controls import CONTROL_INDEX, bundled_measurer
from engine.speech.transcript import Transcript
from engine.speech.visemes import NAMES, class_of
from engine.take import Take

CLOSED_MM = 2.0
AROUND_S = 0.02  # before and after a phone in which its closure may lie
SHIFTS = 200  # of the phones along the take, over which chance is counted
_MBP = NAMES.index("mbp")


@dataclass(frozen=True)
class Closures:
    """How many M, B and P are said, over how many the lips meet, and over how many they would anywhere else."""

    said: int
    closed: int
    by_chance: float


def closures(transcript: Transcript, take: Take, *, offset_s: float = 0.0) -> Closures:
    """Compare what is said, from `offset_s` of the take on, with its lips; lost frames count as open.

    Chance is the mean over phones shifted round the take by equal steps.
    """
    lips = bundled_measurer().measure(take.weights)[:, CONTROL_INDEX["lips_vertical"]]
    shut = (lips < CLOSED_MM) & ~take.lost
    said = [cue for cue in transcript.phones if class_of(cue.label) == _MBP]
    times = np.array([(cue.start_s, cue.stop_s) for cue in said]).reshape(-1, 2) + offset_s
    times = times[(times.mean(axis=1) >= 0) & (times.mean(axis=1) * take.fps < len(take))]
    around_s = np.array([-AROUND_S, AROUND_S])
    frames = np.ceil((times + around_s) * take.fps - 0.5).astype(int)
    frames = np.clip(frames, [0, 1], [len(take) - 1, len(take)])
    frames[:, 1] = np.maximum(frames[:, 1], frames[:, 0] + 1)
    steps = np.linspace(0, len(take), min(SHIFTS, len(take)), endpoint=False).astype(int)
    counts = [_closed(np.roll(shut, int(step)), frames) for step in steps]
    return Closures(len(frames), counts[0], float(np.mean(counts)))


def _closed(shut: np.ndarray, frames: np.ndarray) -> int:
    before = np.concatenate([[0], np.cumsum(shut)])
    return int((before[frames[:, 1]] > before[frames[:, 0]]).sum())
