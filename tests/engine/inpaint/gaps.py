"""Gaps in a synthetic performance, for the tests of the filling network's parts."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from engine.controls import CONTROL_INDEX, measure
from engine.inpaint.gap import Gap, gap_of
from engine.inpaint.statistics import Statistics, statistics_of
from engine.lab.performer import demo
from engine.lab.performer.performer import perform
from engine.take import Array

SPAN = slice(60, 150)


@lru_cache(maxsize=1)
def performance() -> Array:
    """Return eight seconds of the demo's weights, (240, 52)."""
    return perform(replace(demo.SCRIPT, lost_s=())).weights[:240]


@lru_cache(maxsize=1)
def performance_statistics() -> Statistics:
    """Return the statistics of `performance`."""
    return statistics_of(performance())


def torn() -> Array:
    """Return `performance` with NaN in `SPAN`."""
    known = performance().copy()
    known[SPAN] = np.nan
    return known


def controlled(known: Array, truth: Array, *names: str) -> Gap:
    """Return a gap whose missing frames have targets for some controls: those of the truth."""
    targeted = np.isnan(known).any(axis=1)[:, None] & np.isin(list(CONTROL_INDEX), names)
    return gap_of(known, controls=np.where(targeted, measure(truth), np.nan))
