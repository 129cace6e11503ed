from __future__ import annotations

import numpy as np
import pytest

from engine.clean.infer import Cleaner
from engine.clean.network import CleanConfig, CleanNetwork
from engine.clean.takes import clean, run
from engine.errors import EditError
from engine.lab.performer.degrade import Faults, degrade
from engine.lab.performer.performer import Script, perform
from engine.take import Take

CLEANER = Cleaner(CleanNetwork(CleanConfig(hidden=8)))
PHONES = ("SIL", "M", "EY1", "B", "IY", "W", "IY", "SH", "UH", "D", "M", "UW1", "V", "SIL", "AY", "HH", "AE", "V")
PERFORMED = perform(Script(phones=PHONES, blinks_per_min=40))
TIMES = np.arange(len(PERFORMED)) / PERFORMED.fps
TRACKED = degrade(PERFORMED.weights, TIMES, Faults(lost_per_s=0.5, lost_s=(0.2,)), np.random.default_rng(0))
TAKE = Take(TRACKED.weights, PERFORMED.fps, TRACKED.lost)


def test_strength_blends_from_raw_to_clean() -> None:
    full, half, none = (clean(TAKE, strength=strength, cleaner=CLEANER) for strength in (1.0, 0.5, 0.0))
    np.testing.assert_array_equal(none.take.weights, TAKE.weights)
    np.testing.assert_allclose(half.take.weights, (TAKE.weights + full.take.weights) / 2, atol=1e-12)
    np.testing.assert_allclose(full.take.weights, run(TAKE.weights, TAKE.lost, TIMES, CLEANER), atol=1e-12)
    np.testing.assert_allclose(full.removed, TAKE.weights - full.take.weights)


def test_outside_a_span_nothing_changes_and_inside_it_is_as_in_the_whole_take() -> None:
    whole, span = clean(TAKE, cleaner=CLEANER), clean(TAKE, frames=(20, 44), cleaner=CLEANER)
    outside = np.r_[0:20, 44 : len(TAKE)]
    np.testing.assert_array_equal(span.take.weights[outside], TAKE.weights[outside])
    np.testing.assert_allclose(span.take.weights[26:38], whole.take.weights[26:38], atol=1e-6)
    assert span.touched == (20, 44)


def test_the_ends_of_a_take_are_cleaned_fully() -> None:
    whole, end = clean(TAKE, cleaner=CLEANER), clean(TAKE, frames=(30, len(TAKE)), cleaner=CLEANER)
    np.testing.assert_allclose(end.take.weights[-5:], whole.take.weights[-5:], atol=1e-6)


@pytest.mark.parametrize(
    ("strength", "frames"), [(1.5, None), (-0.1, None), (float("nan"), None), (1.0, (5, 5)), (1.0, (0, 10_000))]
)
def test_what_cannot_be_cleaned_is_refused(strength: float, frames: tuple[int, int] | None) -> None:
    with pytest.raises(EditError):
        clean(TAKE, strength=strength, frames=frames, cleaner=CLEANER)


@pytest.mark.parametrize("frames", [1, 2, 3])
def test_the_shortest_takes_are_cleaned(frames: int) -> None:
    short = Take(TAKE.weights[:frames], 30.0)
    assert len(clean(short, cleaner=CLEANER).take) == frames


def test_progress_is_told() -> None:
    told: list[float] = []
    clean(Take(np.zeros((2500, 52)), 60.0), cleaner=CLEANER, progress=told.append)
    assert told == sorted(told) and len(told) == 2 and 0 < told[0] < 1


def test_a_span_is_eased_in_and_out_over_a_tenth_of_a_second() -> None:
    take = Take(np.clip(TRACKED.weights, 0, 1), 30.0)
    whole, span = clean(take, cleaner=CLEANER), clean(take, frames=(10, 40), cleaner=CLEANER)
    moved = whole.take.weights - take.weights
    column = int(np.abs(moved[[10, 11, 12, 37, 38, 39]]).min(axis=0).argmax())
    frames = np.array([9, 10, 11, 12, 13, 36, 37, 38, 39, 40])
    shares = np.array([0, 7 / 27, 20 / 27, 1, 1, 1, 1, 20 / 27, 7 / 27, 0])
    assert np.abs(moved[frames[1:-1], column]).min() > 1e-5
    np.testing.assert_allclose(
        (span.take.weights - take.weights)[frames, column], shares * moved[frames, column], atol=1e-9
    )


def test_a_span_is_as_in_the_take_since_five_seconds_are_listened_to_before_it() -> None:
    rng = np.random.default_rng(1)
    take = Take(rng.random((400, 52)), 30.0)
    heard = clean(take, frames=(200, 230), cleaner=CLEANER)
    from_there = Take(take.weights[50:], 30.0)
    np.testing.assert_allclose(
        clean(from_there, frames=(50 + 100, 80 + 100), cleaner=CLEANER).take.weights[155:175],
        heard.take.weights[205:225],
        atol=1e-12,
    )


def test_no_strength_touches_nothing_and_a_range_before_the_take_is_refused() -> None:
    nothing = clean(TAKE, strength=0.0, frames=(3, 9), cleaner=CLEANER)
    assert nothing.take is TAKE and nothing.touched == (3, 3) and nothing.lag_ms == 0 and not nothing.removed.any()
    with pytest.raises(EditError, match="not within the take"):
        clean(TAKE, frames=(-1, 5), cleaner=CLEANER)
    assert clean(TAKE, frames=(0, len(TAKE)), cleaner=CLEANER).touched == (0, len(TAKE))
