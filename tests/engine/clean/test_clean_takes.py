from __future__ import annotations

import numpy as np
import pytest

from engine.clean.infer import Cleaner
from engine.clean.lag import lag_ms
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


@pytest.mark.parametrize("late_ms", [-50.0, 0.0, 12.0, 80.0])
def test_a_known_lag_is_found(late_ms: float) -> None:
    rng = np.random.default_rng(0)
    times = np.cumsum(rng.uniform(1 / 120, 1 / 24, 600))
    waves = rng.uniform(0.5, 5, (6, 4)), rng.uniform(0, 6, (6, 4))

    def curves(at: np.ndarray) -> np.ndarray:
        return np.sin(at[:, None, None] * waves[0] + waves[1]).sum(axis=1)

    found = lag_ms(curves(times - late_ms / 1e3), curves(times), times)
    assert found == pytest.approx(late_ms, abs=1.0)


def test_what_does_not_move_has_no_lag() -> None:
    assert np.isnan(lag_ms(np.ones((100, 3)), np.ones((100, 3)), np.arange(100) / 30))
