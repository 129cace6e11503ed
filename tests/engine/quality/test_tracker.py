from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.quality import (
    Seen,
    leaps,
    repeats,
)
from engine.quality.tracker import frozen, head, jitter, lost, pops, spikes
from engine.take import SHAPE_INDEX, SHAPES, Array
from tests.engine.quality.takes import (
    FPS,
    JAW,
    found,
    looked,
    still,
)


def test_a_leap_that_returns_is_a_spike_and_one_that_stays_is_none() -> None:
    weights = np.tile(np.linspace(0, 0.2, 30)[:, None], (1, len(SHAPES)))
    kept = np.ones(30, bool)
    assert not leaps(weights, kept).any()
    weights[10, JAW] += 0.3
    assert np.flatnonzero(leaps(weights, kept)).tolist() == [10]
    kept[11] = False
    assert not leaps(weights, kept).any()
    weights[10:, JAW] += 0.3
    weights[10, JAW] -= 0.3
    assert not leaps(weights, np.ones(30, bool)).any()
    assert not repeats(weights, np.ones(30, bool)).any()


def test_a_peak_of_three_frames_is_an_articulation_and_no_spike() -> None:
    weights = still()
    weights[100:103, JAW] += [0.2, 0.4, 0.2]
    assert not found(looked(weights), "spike")
    weights[101, JAW] += 0.5
    assert found(looked(weights), "spike") == [(101, 102)]


def test_a_face_at_rest_is_not_frozen_and_one_that_holds_is() -> None:
    weights = still()
    weights[50:60] = 0.0
    weights[100:110] = weights[100]
    assert found(looked(weights), "frozen") == [(101, 110)]


def test_trembling_is_flagged_over_its_stretches_and_one_spike_is_none() -> None:
    weights = still()
    weights[40, JAW] += 0.5
    assert not found(looked(weights), "jitter")
    weights[90:150, JAW] += 0.05 * (-1.0) ** np.arange(60)
    assert found(looked(weights), "jitter") == [(90, 150)]


def test_a_step_that_stays_is_a_pop_except_for_eyes_and_tongue() -> None:
    weights = still()
    weights[120:, SHAPE_INDEX["mouthFunnel"]] += 0.3
    weights[200:, SHAPE_INDEX["eyeLookInLeft"]] += 0.5
    weights[220:, SHAPE_INDEX["tongueOut"]] += 0.5
    assert found(looked(weights), "pop") == [(120, 121)]


def test_a_head_that_turns_fast_is_fine_and_one_that_jumps_is_not() -> None:
    turned = np.radians(25 * np.sin(2 * np.pi * 1.5 * np.arange(300) / FPS))[:, None] * np.ones(3)
    assert not found(looked(still(), rotations=turned), "head")
    turned[150:] += np.radians([0.0, 12.0, 0.0])
    assert found(looked(still(), rotations=turned), "head") == [(150, 151)]
    assert not found(looked(still()), "head")


def only(weights: Array, **more: object) -> Seen:
    """What is looked at where no control matters."""
    return replace(Seen(weights, np.zeros((len(weights), 16)), FPS, np.zeros(len(weights), bool)), **more)


def of(find: object, seen: Seen) -> list[tuple[int, int, float]]:
    return [(flag.start, flag.stop, round(flag.weight, 6)) for flag in find(seen, 0, seen.length)]  # type: ignore[operator]


def test_frames_without_a_face_weigh_by_how_long_they_last() -> None:
    gone = np.isin(np.arange(300), [*range(10, 25), *range(100, 130), *range(200, 290)])
    assert of(lost, only(still(), lost=gone)) == [(10, 25, 0.6), (100, 130, 1.0), (200, 290, 1.0)]


@pytest.mark.parametrize(("leap", "back", "beside", "flagged"), [
    (0.13, 0.0, 0.0, True),
    (0.12, 0.0, 0.0, False),
    (-0.13, 0.0, 0.0, True),
    (0.3, 0.04, 0.0, True),
    (0.3, 0.05, 0.0, False),
    (0.3, 0.0, 0.1, True),
    (0.3, 0.0, 0.13, False),
])  # fmt: skip
def test_a_spike_leaps_returns_and_stands_alone(leap: float, back: float, beside: float, flagged: bool) -> None:
    for way in (1, -1):  # with what moves beside it before the leap, or after it
        weights = np.full((40, len(SHAPES)), 0.5)
        weights[20, 7] += leap + back / 2
        weights[21:, 7] += back
        weights[:19, 7] += beside * (way > 0)
        weights[22:, 7] += beside * (way < 0)
        assert bool(of(spikes, only(weights))) == flagged
    assert leaps(np.full((2, len(SHAPES)), 0.5), np.ones(2, bool)).tolist() == [0, 0]


def test_a_spike_beside_a_lost_frame_is_none_and_the_furthest_counts() -> None:
    weights = np.full((40, len(SHAPES)), 0.5)
    weights[20, [3, 9]] += [0.2, 0.31]
    assert of(spikes, only(weights)) == [(20, 21, 0.6)]
    for gone in (19, 20, 21):
        assert not of(spikes, only(weights, lost=np.arange(40) == gone))
    assert of(spikes, only(weights, lost=np.arange(40) == 18)) and of(spikes, only(weights, lost=np.arange(40) == 22))
    quiet = leaps(np.where(np.arange(40)[:, None] == 20, 0.58, weights), np.ones(40, bool), least=0.05, quiet=None)
    assert np.flatnonzero(quiet).tolist() == [20] and quiet[20] == pytest.approx(0.08)


def test_a_freeze_of_five_frames_counts_and_weighs_by_its_length() -> None:
    weights = still()
    weights[51:55] = weights[50]
    weights[101:106] = weights[100]
    weights[151:166] = weights[150]
    flags = of(frozen, only(weights))
    assert flags == [(101, 106, round(0.2 + 0.8 * (5 / 30) / 0.5, 6)), (151, 166, 1.0)]
    gone = np.arange(300) == 102
    assert of(frozen, only(weights, lost=gone)) == [flags[1]]


@pytest.mark.parametrize(("step", "flagged"), [(0.151, True), (-0.151, True), (0.149, False)])
def test_a_pop_steps_by_more_than_its_threshold(step: float, flagged: bool) -> None:
    weights = np.full((60, len(SHAPES)), 0.5)
    weights[30:, 20] += step
    assert bool(of(pops, only(weights))) == flagged
    weights[30:, 20] += np.sign(step) * 0.3
    assert of(pops, only(weights))[0][:2] == (30, 31)


@pytest.mark.parametrize(("near", "by", "flagged"), [
    (28, 0.099, False), (28, 0.059, True), (27, 0.2, True), (32, 0.099, False), (32, 0.059, True), (33, 0.2, True)
])  # fmt: skip
def test_a_pop_has_a_still_stretch_on_either_side(near: int, by: float, flagged: bool) -> None:
    weights = np.full((60, len(SHAPES)), 0.2)
    weights[30:, 20] += 0.3
    weights[near:, 20] += by
    assert ((30, 31) in [flag[:2] for flag in of(pops, only(weights))]) == flagged


@pytest.mark.parametrize(("gone", "flagged"), [(26, True), (27, False), (30, False), (32, False), (33, True)])
def test_a_pop_beside_lost_frames_or_the_ends_is_none(gone: int, flagged: bool) -> None:
    weights = np.full((60, len(SHAPES)), 0.2)
    weights[30:, 20] += 0.3
    assert bool(of(pops, only(weights, lost=np.arange(60) == gone))) == flagged
    for at in (1, 2, 58, 59):
        early = np.where(np.arange(60)[:, None] < at, 0.2, 0.6) * np.ones(len(SHAPES))
        assert not of(pops, only(early))
    assert of(pops, only(np.where(np.arange(60)[:, None] < 3, 0.2, 0.6) * np.ones(len(SHAPES)))) != []


def test_trembling_is_measured_as_the_deviation_of_noise_with_such_fourth_differences() -> None:
    for by in (0.02, 0.05):
        weights = np.full((300, len(SHAPES)), 0.5)
        weights[:, 30] += by * (-1.0) ** np.arange(300)
        (flag,) = jitter(only(weights), 0, 300)
        told = float(flag.sentence.split(" by ")[1].split()[0])
        assert told == pytest.approx(
            16 * by / np.sqrt(70) / 0.8, abs=6e-4
        )  # 1 -4 6 -4 1; the mean of |x| is 0.8 deviations
        assert (flag.start, flag.stop) == (0, 300) and "10.00 s" in flag.sentence


@pytest.mark.parametrize(("deviation", "share", "flagged"), [
    (0.007, 1.0, False), (0.009, 1.0, True), (0.03, 0.9, True), (0.03, 0.3, False)
])  # fmt: skip
def test_trembling_is_on_most_frames_of_a_stretch(deviation: float, share: float, flagged: bool) -> None:
    weights = np.full((60, len(SHAPES)), 0.5)
    noisy = np.arange(15) < round(15 * share)
    weights[30:45, 30] += deviation * (-1.0) ** np.arange(15) * noisy
    assert bool(of(jitter, only(weights))) == flagged
    assert not of(jitter, only(weights, lost=np.arange(60) == 37))


def test_fast_motion_is_no_trembling() -> None:
    weights = np.full((150, len(SHAPES)), 0.5)
    weights[:, 30] += 0.4 * np.sin(np.arange(150) * 0.9)
    assert not of(jitter, only(weights))


@pytest.mark.parametrize(("jump_deg", "flagged"), [(5.5, True), (-5.5, True), (4.5, False)])
def test_a_head_jumps_by_more_than_it_turns_beside(jump_deg: float, flagged: bool) -> None:
    turned = np.radians(np.arange(60.0)[:, None] * 2 * np.ones(3))
    turned[30:, 1] += np.radians(jump_deg)
    seen = only(still(60), rotations=turned)
    assert [flag[:2] for flag in of(head, seen)] == [(30, 31)] * flagged
    for gone in (28, 29, 30, 31):
        assert not of(head, replace(seen, lost=np.arange(60) == gone))
    assert bool(of(head, replace(seen, lost=np.arange(60) == 27))) == flagged
    assert bool(of(head, replace(seen, lost=np.arange(60) == 32))) == flagged


def test_a_head_that_passes_behind_does_not_jump_and_one_of_few_frames_neither() -> None:
    turned = np.radians((170 + np.arange(30.0) + 180) % 360 - 180)[:, None] * [1, 0, 0]
    assert not of(head, only(still(30), rotations=turned))
    assert not of(head, only(still(3), rotations=np.radians([[0.0, 0, 0], [90, 0, 0], [0, 0, 0]])))
    assert [
        flag[:2]
        for flag in of(head, only(still(4), rotations=np.radians([[0.0] * 3, [0] * 3, [90, 0, 0], [90, 0, 0]])))
    ] == [(2, 3)]


@pytest.mark.parametrize(("fps", "held", "frozen"), [(30.0, 4, 0), (30.0, 5, 1), (60.0, 8, 0), (60.0, 9, 1)])
def test_a_pose_is_frozen_when_it_is_held_for_long_enough_at_any_rate(fps: float, held: int, frozen: int) -> None:
    weights = still()
    weights[100 : 100 + held] = weights[99]
    assert len(found(replace(looked(weights), fps=fps), "frozen")) == frozen
