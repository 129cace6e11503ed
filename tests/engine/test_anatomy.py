from __future__ import annotations

import numpy as np

from engine.anatomy import EXCLUSIVE, clash, impossible, pairs
from engine.lab.performer.corpus import synthetic_performances
from engine.take import SHAPE_INDEX, SHAPES


def test_every_listed_pair_is_found_on_its_own_side() -> None:
    for first, second, reason in EXCLUSIVE:
        weights = np.zeros((1, len(SHAPES)))
        one, other = (name if name in SHAPE_INDEX else f"{name}Left" for name in (first, second))
        weights[0, [SHAPE_INDEX[one], SHAPE_INDEX[other]]] = 0.6
        assert impossible(weights)[0], reason
    weights = np.zeros((1, len(SHAPES)))
    weights[0, [SHAPE_INDEX["eyeBlinkLeft"], SHAPE_INDEX["eyeWideRight"]]] = 1.0
    assert not impossible(weights)[0]


def test_a_performance_is_possible() -> None:
    assert impossible(synthetic_performances(0.5, seed=2)[0]).mean() < 0.01


def test_the_strongest_pair_is_named() -> None:
    weights = np.random.default_rng(0).random((200, len(SHAPES)))
    strongest, which = clash(weights)
    for frame, row in enumerate(weights):
        found = [(min(row[first], row[second]), rule) for first, second, rule in pairs()]
        assert (strongest[frame], which[frame]) == max(found, key=lambda pair: pair[0])  # of equals the first
