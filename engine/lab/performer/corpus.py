"""Synthetic performances by the minute, for training."""

from __future__ import annotations

import numpy as np

from engine.lab.performer.performer import Script, perform
from engine.lab.performer.visemes import VISEMES
from engine.take import Array

_VOWELS = [phone for viseme in VISEMES[10:] for phone in viseme.phones]
_CONSONANTS = [phone for viseme in VISEMES[1:10] for phone in viseme.phones]


def random_script(rng: np.random.Generator, syllables: int = 60) -> Script:
    """Return nonsense speech: consonant-vowel syllables with stress, pauses and smiles."""
    phones = ["SIL"]
    for _ in range(syllables):
        phones += list(rng.choice(_CONSONANTS, rng.integers(0, 3)))
        phones.append(str(rng.choice(_VOWELS)) + ("1" if rng.random() < 0.25 else ""))
        if rng.random() < 0.12:
            phones += ["SIL"] * int(rng.integers(1, 5))
    starts = rng.uniform(0, 12, 2)
    smiles = tuple((float(s), float(s + rng.uniform(1, 3))) for s in starts)
    tempo = float(rng.uniform(0.7, 1.2))
    return Script(
        tuple(phones), smiles, blinks_per_min=float(rng.uniform(12, 30)), tempo=tempo, seed=int(rng.integers(2**31))
    )


def synthetic_performances(minutes: float, *, seed: int) -> list[Array]:
    """Return weights, (frames, 52) each, of nonsense performances of the given length in all."""
    rng = np.random.default_rng(seed)
    result: list[Array] = []
    while sum(len(weights) for weights in result) < minutes * 60 * 30:
        result.append(perform(random_script(rng)).weights)
    return result
