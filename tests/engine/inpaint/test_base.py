from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.controls import CONTROL_INDEX, measure
from engine.inpaint.base import base_of
from engine.inpaint.gap import gap_of
from engine.inpaint.statistics import Statistics, statistics_of
from engine.take import Array
from tests.engine.inpaint.gaps import SPAN, controlled


@pytest.mark.parametrize("names", [tuple(CONTROL_INDEX), ("lips_vertical", "lips_horizontal", "eyelid_left")])
def test_control_targets_bring_the_base_nearer_to_the_truth_and_are_met(
    known: Array, truth: Array, statistics: Statistics, names: tuple[str, ...]
) -> None:
    gap = controlled(known, truth, *names)
    base, plain = base_of(gap, statistics).base, base_of(gap_of(known), statistics).base
    there = np.isfinite(known)
    np.testing.assert_array_equal(base[there], truth[there])
    assert np.square(base - truth)[SPAN].mean() < 0.8 * np.square(plain - truth)[SPAN].mean()
    columns = [CONTROL_INDEX[name] for name in names]
    off, before = (np.abs(measure(face)[SPAN] - measure(truth)[SPAN])[:, columns].mean() for face in (base, plain))
    assert off < 0.25 * before


def test_the_base_is_as_before_far_from_control_targets(known: Array, truth: Array) -> None:
    statistics = statistics_of(truth)
    gap = controlled(known, truth, "lips_vertical")
    part = gap.controls.copy()
    part[90:] = np.nan
    base, plain = (base_of(each, statistics).base for each in (replace(gap, controls=part), gap_of(known)))
    np.testing.assert_allclose(base[112:], plain[112:], atol=1e-3)
    assert np.abs(np.diff(base[80:112], axis=0)).max() < 0.1
