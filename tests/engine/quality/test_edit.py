from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.controls import ALL_CONTROLS
from engine.quality import Seen
from engine.quality.edit import missed, seams
from engine.take import SHAPES, Array
from tests.engine.quality.takes import (
    JAW,
    found,
    looked,
    still,
)


def test_an_edit_with_hard_borders_shows_and_an_eased_one_does_not() -> None:
    before = still()
    eased, hard, kinked = before.copy(), before.copy(), before.copy()
    eased[100:160, JAW] += 0.3 * np.sin(np.linspace(0, np.pi, 60)) ** 2
    hard[100:160, JAW] += 0.3
    kinked[100:160, JAW] += 0.5 * (1 - np.abs(np.linspace(-1, 1, 62)[1:-1])) * 2
    assert not found(looked(eased, original_weights=before), "seam")
    assert found(looked(hard, original_weights=before), "seam") == [(100, 101), (160, 161)]
    kinked[100:104, JAW] = before[100:104, JAW] + [0.05, 0.3, 0.55, 0.5]
    assert (100, 101) in found(looked(kinked, original_weights=before), "seam")
    assert not found(looked(hard), "seam")


@pytest.mark.parametrize(("by", "flagged"), [(2.1, True), (-2.1, True), (2.0, False), (5.0, True), (50.0, True)])
def test_what_was_asked_and_not_reached_is_told_with_both_values(by: float, flagged: bool) -> None:
    controls = np.full((40, len(ALL_CONTROLS)), 12.0)
    asked = np.full_like(controls, np.nan)
    asked[10:16, 3] = 12.0
    asked[12:14, 3] += by
    asked[13, 3] -= by / 100
    seen = Seen(still(40), controls, 30.0, np.zeros(40, bool), asked)
    flags = list(missed(seen, 0, 40))
    assert [(flag.start, flag.stop) for flag in flags] == ([(12, 14)] if abs(by) > 2.02 else [(12, 13)]) * flagged
    if flagged:
        assert flags[0].weight == pytest.approx(min(1.0, 0.2 + 0.8 * (abs(by) - 2) / 6))
        assert f"{12 + by:.1f} {ALL_CONTROLS[3].unit} was asked for" in flags[0].sentence
        assert f"gets to 12.0 {ALL_CONTROLS[3].unit}" in flags[0].sentence
        assert [(f.start, f.stop) for f in missed(seen, 12, 13)] == [(12, 13)]
    assert not list(missed(replace(seen, asked=None), 0, 40))


def test_what_misses_by_just_the_threshold_is_no_part_of_what_is_told() -> None:
    controls = np.full((40, len(ALL_CONTROLS)), 12.0)
    asked = np.full_like(controls, np.nan)
    asked[10:16, 3] = [14.0, 14.5, 15.0, 9.5, 10.0, 12.0]
    (flag,) = missed(Seen(still(40), controls, 30.0, np.zeros(40, bool), asked), 0, 40)
    assert (flag.start, flag.stop) == (11, 14) and "15.0" in flag.sentence


def edited(change: Array, before: Array | None = None) -> Seen:
    """A take whose shape 20 was changed by so much."""
    original = np.full((len(change), len(SHAPES)), 0.3) if before is None else before
    weights = original.copy()
    weights[:, 20] += change
    return Seen(weights, np.zeros((len(change), 16)), 30.0, np.zeros(len(change), bool), original_weights=original)


@pytest.mark.parametrize(("step", "flagged"), [(0.061, True), (-0.061, True), (0.059, False), (0.28, True)])
def test_a_step_at_a_border_shows_beyond_its_threshold(step: float, flagged: bool) -> None:
    change = np.zeros(60)
    change[20:40] = step
    flags = [flag for flag in seams(edited(change), 0, 60) if "steps by" in flag.sentence]
    assert [(flag.start, flag.stop) for flag in flags] == [(20, 21), (40, 41)] * flagged
    assert all(flag.weight == pytest.approx(min(1.0, 0.2 + 0.8 * (abs(step) - 0.06) / 0.44)) for flag in flags)


def test_a_step_is_hidden_where_the_take_itself_steps_as_far_near_there_and_not_elsewhere() -> None:
    change = np.zeros(90)
    change[40:60] = 0.2
    for at, hidden in ((40, True), (33, True), (47, True), (20, False), (80, False)):
        before = np.full((90, len(SHAPES)), 0.3)
        before[at:, 20] += 0.25
        found = [flag.start for flag in seams(edited(change, before), 0, 90) if "steps by" in flag.sentence]
        assert (40 not in found) == hidden, at


@pytest.mark.parametrize(("slope", "flagged"), [(0.055, False), (0.058, True)])
def test_a_turn_at_a_border_shows_beyond_three_a_second(slope: float, flagged: bool) -> None:
    change = np.zeros(60)
    change[20:] = slope * np.minimum(np.arange(1, 41), 20)
    seen = edited(change)
    seen = replace(seen, fps=53.0)  # 3 a second are 0.0566 a frame
    (flag,) = list(seams(seen, 0, 60)) or [None]
    assert (flag is not None) == flagged
    if flag is not None:
        assert (flag.start, flag.stop, flag.weight) == (
            20,
            21,
            pytest.approx(0.2),
        ) and "turns sharply (by 3.1" in flag.sentence


def test_borders_are_told_within_the_range_that_is_asked_alone() -> None:
    change = np.zeros(90)
    change[30:60] = 0.3
    seen = edited(change)
    for low, high, starts in ((0, 90, [30, 60]), (31, 60, []), (30, 31, [30]), (0, 30, []), (60, 90, [60])):
        assert [flag.start for flag in seams(seen, low, high)] == starts
    assert not list(seams(replace(seen, original_weights=None), 0, 90))
    assert not list(seams(edited(np.full(90, 0.3)), 0, 90))
