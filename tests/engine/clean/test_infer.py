from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.clean.inertialisation import Inertialisation
from engine.clean.infer import TUNING, Cleaner, CleanState, bundled, plausible
from engine.take import SHAPES

RNG = np.random.default_rng(1)
POSE = np.where(RNG.random(len(SHAPES)) < 0.4, RNG.uniform(0.1, 0.9, len(SHAPES)), 0.0).astype(np.float32)
MOVING = (POSE * (0.6 + 0.4 * np.sin(np.arange(240)[:, None] / 9))).astype(np.float32)


def follow(cleaner: Cleaner, frames: list[np.ndarray | None], fps: float = 60.0) -> list[CleanState]:
    states = [cleaner.start(next(frame for frame in frames if frame is not None))]
    for frame in frames:
        states.append(cleaner.step(frame, 1 / fps, states[-1]))
    return states[1:]


@pytest.mark.parametrize("fps", [30.0, 60.0, 120.0])
def test_a_constant_face_comes_to_rest(fps: float) -> None:
    shown = np.array([state.output for state in follow(bundled(), [POSE] * round(40 * fps), fps)])
    assert np.abs(shown[-round(10 * fps) :] - shown[-1]).max() < 1e-3
    assert np.abs(shown[-1] - POSE).max() < 0.25


def test_an_hour_of_one_and_the_same_frame_does_not_drift() -> None:
    frozen = follow(bundled(), [POSE] * 60 * 90)
    stands = frozen[60 * 60 :]
    assert all(np.array_equal(state.output, stands[0].output) for state in stands)  # to the last bit
    # what is left of each step only shrinks, so nothing moves in the rest of the hour either
    left = np.exp(-(stands[0].frozen_s - TUNING.frozen_s) / TUNING.frozen_s) * 3600 * 60
    assert left < 1e-3 and np.abs(stands[0].velocity).max() == 0
    hour = follow(bundled(), [POSE] * 7200, fps=2.0)  # and a whole hour in long steps
    assert np.abs(hour[-1].output - hour[120].output).max() < 1e-3


@pytest.mark.parametrize("fps", [24.0, 60.0, 120.0])
def test_moving_shapes_are_extrapolated_and_still_ones_are_not(fps: float) -> None:
    ramp = np.clip(np.arange(round(0.5 * fps)) / fps, 0, 1)[:, None] * 1.6 * (POSE > 0.3)
    for state in follow(bundled(), [*ramp.astype(np.float32)], fps):
        slow = np.abs(state.velocity) <= TUNING.slow_per_s
        assert not state.lead[slow].any()
        assert (state.lead[~slow] * state.velocity[~slow] > 0).all()
        assert (np.abs(state.lead) <= TUNING.lead_s * np.abs(state.velocity)).all()
    still = follow(bundled(), [POSE] * 200, fps)[-1]
    assert not still.lead.any()


def test_the_jump_that_ends_a_lost_run_is_not_extrapolated() -> None:
    frames = [*[MOVING[0]] * 60, *[None] * 30, 1 - MOVING[0]]
    *_, before, after = follow(bundled(), frames)
    np.testing.assert_array_equal(after.lead, before.lead)
    assert np.abs(after.velocity).max() > 1.0


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 100.0, -100.0])
def test_one_bad_packet_is_no_worse_than_a_lost_one(bad: float) -> None:
    frames: list[np.ndarray | None] = list(MOVING)
    spoilt, missing = list(frames), list(frames)
    spoilt[100], missing[100] = np.where(np.arange(len(SHAPES)) == 17, bad, MOVING[100]), None
    for one, other in zip(follow(bundled(), spoilt), follow(bundled(), missing), strict=True):
        np.testing.assert_array_equal(one.output, other.output)
    undisturbed = follow(bundled(), frames)[-1].output
    assert np.abs(follow(bundled(), spoilt)[-1].output - undisturbed).max() < 0.01


@pytest.mark.parametrize("gap", [1, 6, 60, 240])
def test_a_lost_run_is_left_and_ended_without_a_pop(gap: int) -> None:
    frames = [*MOVING[:120], *[None] * gap, *np.minimum(1, MOVING[120:] + 0.5 * (POSE > 0))]
    shown = np.array([state.output for state in follow(bundled(), frames)])
    speed = np.abs(np.diff(shown, axis=0)).max(axis=1)
    assert np.isfinite(shown).all() and speed[119 : 119 + gap].max() < 0.1  # no leap as the bridge begins
    jump = np.abs(shown[119 + gap] - frames[-120]).max()  # how far the bridge is from the face that returns
    if gap > 1:
        assert speed[119 + gap] < max(0.35 * jump, 0.05)  # not a frame's leap, as it would be without inertialisation
    assert np.abs(shown[-1] - shown[-2]).max() < 0.05


def test_the_output_is_always_a_face() -> None:
    rng = np.random.default_rng(2)
    wild = [row if rng.random() > 0.2 else None for row in rng.uniform(-0.9, 1.9, (300, len(SHAPES)))]
    wild[0] = MOVING[0]
    for state in follow(bundled(), wild):
        assert state.output.min() >= 0 and state.output.max() <= 1
    stepped = bundled().step(MOVING[0], 0.0, bundled().start(MOVING[0]))
    assert np.isfinite(stepped.velocity).all()


def test_the_output_is_the_estimate_with_lead_and_offset() -> None:
    still = bundled().start(np.full(len(SHAPES), 0.5))
    away = np.full(len(SHAPES), 0.25, np.float32)
    state = replace(still, lead=away / 5, offset=Inertialisation(-away, 0 * away))
    np.testing.assert_allclose(state.output, 0.5 + 0.05 - 0.25, rtol=1e-6)
    assert (replace(still, lead=4 * away).output == 1).all() and (replace(still, lead=-4 * away).output == 0).all()


@pytest.mark.parametrize(("fps", "share"), [(24.0, 0.16), (30.0, 0.25), (60.0, 1.0), (120.0, 1.0)])
def test_fast_shapes_lead_by_eight_milliseconds_of_what_exceeds_a_slow_motion(fps: float, share: float) -> None:
    ramp = np.clip(np.arange(round(0.4 * fps)) / fps, 0, 1)[:, None] * 2 * (POSE > 0.3)
    state = follow(bundled(), [*ramp.astype(np.float32)], fps)[-1]
    beyond = np.sign(state.velocity) * np.maximum(np.abs(state.velocity) - 0.5, 0)
    assert np.abs(beyond).max() > 0.04
    np.testing.assert_allclose(state.lead, share * 0.008 * beyond, rtol=1e-4, atol=1e-9)


def test_one_frame_for_long_is_followed_less_and_less() -> None:
    before = follow(bundled(), [*MOVING[:60]])[-1]
    fresh, stale, old = (
        bundled().step(before.observed, 1 / 60, replace(before, frozen_s=seconds)) for seconds in (0.0, 0.9, 5.0)
    )
    inside = (fresh.weights > 0.01) & (fresh.weights < 0.99)
    jump, less = (fresh.weights - before.weights)[inside], (old.weights - before.weights)[inside]
    np.testing.assert_array_equal(stale.weights, fresh.weights)
    assert np.abs(jump).max() > 1e-3
    np.testing.assert_allclose(less, jump * np.exp(-(5 + 1 / 60 - 1)), atol=1e-6)
    assert old.frozen_s == pytest.approx(5 + 1 / 60, abs=1e-6)


@pytest.mark.parametrize(
    ("asked_s", "taken_s"), [(0.0, 0.001), (-3.0, 0.001), (0.0005, 0.001), (0.7, 0.5), (60.0, 0.5)]
)
def test_steps_are_held_to_what_a_face_may_be_extrapolated_over(asked_s: float, taken_s: float) -> None:
    before = follow(bundled(), [*MOVING[:30]])[-1]
    one, other = (bundled().step(MOVING[30], step_s, before) for step_s in (asked_s, taken_s))
    np.testing.assert_array_equal(one.weights, other.weights)
    np.testing.assert_array_equal(one.velocity, other.velocity)


def test_a_frame_counts_as_a_face_up_to_the_limits_and_no_further() -> None:
    frame = np.full(len(SHAPES), 0.5)
    for value, clamped in ((-1.0, 0.0), (2.0, 1.0), (0.25, 0.25)):
        frame[3] = value
        found = plausible(frame)
        assert found is not None and found[3] == clamped and found[4] == 0.5
    for value in (-1.001, 2.001, np.nan):
        frame[3] = value
        assert plausible(frame) is None
    assert plausible(None) is None
