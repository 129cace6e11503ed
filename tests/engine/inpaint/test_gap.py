"""The ground under steered fills: along guides as far as they are believed, and as control curves let expect."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from engine.controls import CONTROL_INDEX, measure
from engine.inpaint.gap import Gap, Statistics, gap_of, ground, left_open, statistics_of, substantial
from engine.inpaint.infer import QUICK_FRAMES, bundled
from engine.inpaint.network import noise_curves
from engine.inpaint.seams import bridged
from engine.lab.performer import demo
from engine.lab.performer.performer import perform
from engine.take import SHAPES, Array

SPAN = slice(60, 150)


@pytest.fixture(scope="module")
def truth() -> Array:
    return perform(replace(demo.SCRIPT, lost_s=())).weights[:240]


@pytest.fixture(scope="module")
def statistics(truth: Array) -> Statistics:
    return statistics_of(truth)


@pytest.fixture
def known(truth: Array) -> Array:
    known = truth.copy()
    known[SPAN] = np.nan
    return known


def controlled(known: Array, truth: Array, *names: str) -> Gap:
    asked = np.where(np.isnan(known).any(axis=1)[:, None] & np.isin(list(CONTROL_INDEX), names), measure(truth), np.nan)
    return gap_of(known, controls=asked)


def test_a_guide_that_only_shakes_is_not_followed(known: Array, statistics: Statistics) -> None:
    plain, shaking = bridged(known), 0.05 * np.random.default_rng(0).standard_normal(known.shape)
    base = ground(gap_of(known, guide=plain + shaking), statistics).base
    middle = slice(SPAN.start + 10, SPAN.stop - 10)
    assert np.square(base - plain)[middle].mean() < 0.02 * np.square(shaking)[middle].mean()


def test_a_clean_guide_is_followed_far_from_seams(known: Array, statistics: Statistics) -> None:
    at = np.arange(len(known))[:, None]
    guide = np.clip(0.4 + 0.3 * np.sin(at / 12 + np.arange(len(SHAPES))), 0, 1)
    base = ground(gap_of(known, guide=guide), statistics).base
    middle = slice(SPAN.start + 15, SPAN.stop - 15)
    off, apart = np.abs(base - guide)[middle].mean(), np.abs(bridged(known) - guide)[middle].mean()
    assert off < 0.15 * apart


def test_a_guide_says_the_less_the_nearer_the_seams(truth: Array, statistics: Statistics) -> None:
    shares = []
    for frames in (4, 10, 40):
        known = truth.copy()
        known[60 : 60 + frames] = np.nan
        plain = bridged(known)
        base = ground(gap_of(known, guide=np.clip(plain + 0.08, 0, 1)), statistics).base
        shares.append(np.abs(base - plain)[60 : 60 + frames].max(axis=0).mean())
    assert shares[0] < 0.6 * shares[1] < 0.6 * shares[2]


@pytest.mark.parametrize("names", [tuple(CONTROL_INDEX), ("lips_vertical", "lips_horizontal", "eyelid_left")])
def test_controls_bring_the_ground_nearer_to_the_truth_and_are_kept(
    known: Array, truth: Array, statistics: Statistics, names: tuple[str, ...]
) -> None:
    gap = controlled(known, truth, *names)
    base, plain = ground(gap, statistics).base, ground(gap_of(known), statistics).base
    there = np.isfinite(known)
    np.testing.assert_array_equal(base[there], truth[there])
    assert np.square(base - truth)[SPAN].mean() < 0.8 * np.square(plain - truth)[SPAN].mean()
    columns = [CONTROL_INDEX[name] for name in names]
    off, before = (np.abs(measure(face)[SPAN] - measure(truth)[SPAN])[:, columns].mean() for face in (base, plain))
    assert off < 0.25 * before


def test_the_ground_is_as_before_where_no_control_is_asked_for_long(known: Array, truth: Array) -> None:
    statistics = statistics_of(truth)
    gap = controlled(known, truth, "lips_vertical")
    part = gap.controls.copy()
    part[90:] = np.nan
    base, plain = (ground(one, statistics).base for one in (replace(gap, controls=part), gap_of(known)))
    np.testing.assert_allclose(base[112:], plain[112:], atol=1e-3)
    assert np.abs(np.diff(base[80:112], axis=0)).max() < 0.1


def test_fewer_controls_leave_more_open_and_none_nothing(known: Array, truth: Array, statistics: Statistics) -> None:
    three = left_open(controlled(known, truth, "lips_vertical", "lips_horizontal", "eyelid_left"), statistics)
    eight = left_open(controlled(known, truth, *CONTROL_INDEX), statistics)
    assert (eight <= three + 1e-9).all() and eight.mean() < three.mean() and eight.min() >= 0 and three.max() <= 1
    assert not three[np.isfinite(known)].any()
    assert not left_open(gap_of(known), statistics).any()


def test_life_is_quick_and_only_where_controls_are_asked(known: Array, truth: Array) -> None:
    filler = bundled()
    gap = controlled(known, truth, "lips_vertical")
    drawn = noise_curves(len(known), np.random.default_rng(0))[None]
    life = filler._life(gap, ground(gap, filler.statistics), drawn)[0]
    assert not life[: SPAN.start].any() and not life[SPAN.stop :].any() and life[100:110].any()
    slow = gaussian_filter1d(life, 2 * QUICK_FRAMES, axis=0)
    assert np.square(slow).mean() < 0.1 * np.square(life).mean()
    nothing = gap_of(known)
    assert not filler._life(nothing, ground(nothing, filler.statistics), drawn).any()


def test_slight_motion_stays_out_where_something_steers(known: Array, truth: Array) -> None:
    motion = np.random.default_rng(0).standard_normal(known.shape) * np.geomspace(1e-4, 0.3, len(SHAPES))
    np.testing.assert_array_equal(substantial(motion, gap_of(known)), motion)
    steered = substantial(motion, controlled(known, truth, "lips_vertical"))[SPAN]
    share = np.abs(steered).mean(axis=0) / np.abs(motion[SPAN]).mean(axis=0)
    assert (share <= 1).all() and (np.diff(share) > -0.05).all() and share[0] < 0.01 and share[-1] > 0.95


def test_asked_controls_are_kept_by_the_fill_itself(known: Array, truth: Array) -> None:
    gap = controlled(known, truth, "lips_vertical", "lips_horizontal", "eyelid_left")
    made = bundled().fill(gap, seeds=range(3))
    asked = np.isfinite(gap.controls)
    off = np.sqrt(np.mean([(measure(one) - gap.controls)[asked] ** 2 for one in made]))
    assert off < 1.0 and np.abs(made[0] - made[1])[SPAN].mean() > 1e-3
