from __future__ import annotations

import numpy as np

from engine.inpaint.base import base_of
from engine.inpaint.gap import gap_of
from engine.inpaint.seams import bridge_weights
from engine.inpaint.statistics import Statistics
from engine.take import SHAPES, Array
from tests.engine.inpaint.gaps import SPAN


def test_a_guide_that_only_shakes_is_not_followed(known: Array, statistics: Statistics) -> None:
    plain, shaking = bridge_weights(known), 0.05 * np.random.default_rng(0).standard_normal(known.shape)
    base = base_of(gap_of(known, guide=plain + shaking), statistics).base
    middle = slice(SPAN.start + 10, SPAN.stop - 10)
    assert np.square(base - plain)[middle].mean() < 0.02 * np.square(shaking)[middle].mean()


def test_a_clean_guide_is_followed_far_from_seams(known: Array, statistics: Statistics) -> None:
    at = np.arange(len(known))[:, None]
    guide = np.clip(0.4 + 0.3 * np.sin(at / 12 + np.arange(len(SHAPES))), 0, 1)
    base = base_of(gap_of(known, guide=guide), statistics).base
    middle = slice(SPAN.start + 15, SPAN.stop - 15)
    off, apart = np.abs(base - guide)[middle].mean(), np.abs(bridge_weights(known) - guide)[middle].mean()
    assert off < 0.15 * apart


def test_a_guide_says_the_less_the_nearer_the_seams(truth: Array, statistics: Statistics) -> None:
    shares = []
    for frames in (4, 10, 40):
        known = truth.copy()
        known[60 : 60 + frames] = np.nan
        plain = bridge_weights(known)
        base = base_of(gap_of(known, guide=np.clip(plain + 0.08, 0, 1)), statistics).base
        shares.append(np.abs(base - plain)[60 : 60 + frames].max(axis=0).mean())
    assert shares[0] < 0.6 * shares[1] < 0.6 * shares[2]
