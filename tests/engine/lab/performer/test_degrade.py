from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from engine.formats import read_take
from engine.lab.corpus import data_folder
from engine.lab.performer.degrade import NONE, Faults, changing_times, degrade, hold, measure, scaled
from engine.lab.performer.demo import BUNDLED
from engine.take import SHAPES, Take

TIMES = np.arange(600) / 60
WEIGHTS = 0.5 + 0.4 * np.sin(TIMES[:, None] * np.linspace(0.5, 3, len(SHAPES)))


def test_no_faults_change_nothing() -> None:
    tracked = degrade(WEIGHTS, TIMES, NONE, np.random.default_rng(0))
    np.testing.assert_allclose(tracked.weights, WEIGHTS, atol=1e-12)
    assert not tracked.lost.any() and scaled(Faults(), 0.0).amplitude == 1.0


def test_the_same_seed_spoils_alike() -> None:
    one, other = (degrade(WEIGHTS, TIMES, Faults(), np.random.default_rng(4)) for _ in range(2))
    np.testing.assert_array_equal(one.weights, other.weights)
    np.testing.assert_array_equal(one.lost, other.lost)


@pytest.mark.parametrize("name", [field.name for field in fields(Faults)])
def test_every_fault_does_something(name: str) -> None:
    often = {"spikes_per_s": 5.0, "frozen_per_s": 2.0, "lost_per_s": 1.0}
    helpers = {"spike_size": {"spikes_per_s": 5.0}, "frozen_s": {"frozen_per_s": 2.0}, "lost_s": {"lost_per_s": 1.0}}
    partners = {
        "spikes_per_s": {"spike_size": 0.5},
        "frozen_per_s": {"frozen_s": 0.1},
        "lost_per_s": {"lost_s": (0.2,)},
    }
    value = often.get(name, getattr(Faults(), name))
    faults = replace(NONE, **{name: value}, **helpers.get(name, {}), **partners.get(name, {}))
    tracked = degrade(WEIGHTS, TIMES, faults, np.random.default_rng(1))
    assert np.abs(tracked.weights - WEIGHTS).max() > 0.001
    assert tracked.lost.any() == (name in ("lost_per_s", "lost_s"))


def test_jitter_and_spikes_are_measured_as_strong_as_they_were_made() -> None:
    times = np.arange(3600) / 30
    still = np.tile(np.r_[np.full(26, 0.05), np.full(26, 0.5)], (len(times), 1))
    faults = replace(NONE, jitter_rest=0.01, jitter_active=0.05)
    found = measure(Take(degrade(still, times, faults, np.random.default_rng(0)).weights, 30.0))
    assert found["jitter_rest"] == pytest.approx(0.01 + 0.05 * 0.05, rel=0.3)
    assert found["jitter_active"] == pytest.approx(0.07, rel=0.3)
    spiky = degrade(still, times, replace(NONE, spikes_per_s=0.5, spike_size=1.0), np.random.default_rng(0))
    assert measure(Take(spiky.weights, 30.0))["spikes_per_s"] == pytest.approx(0.5, rel=0.4)


def test_the_strengths_are_those_of_the_dirty_takes() -> None:
    folder = data_folder() / "livelink"
    if not (folder / "apfel.csv").exists():
        pytest.skip("needs the recorded takes: set RETAKE_DATA")
    apfel, other = (measure(read_take(folder / name)) for name in ("apfel.csv", "S88-001.csv"))
    faults = Faults()
    for name in ("jitter_rest", "jitter_active", "spikes_per_s"):
        assert getattr(faults, name) == pytest.approx(apfel[name], rel=0.1)
    assert faults.lost_per_s == pytest.approx((apfel["lost_per_s"] + other["lost_per_s"]) / 2, rel=0.1)
    assert max(faults.lost_s) == pytest.approx(other["lost_longest_s"], rel=0.1)


def test_holding_repeats_the_last_frame_that_is_there() -> None:
    curve = np.arange(6.0)[:, None]
    missing = np.array([True, False, True, True, False, True])
    np.testing.assert_array_equal(hold(curve, missing)[:, 0], [0, 1, 1, 1, 4, 4])


def test_a_changing_rate_stays_between_its_bounds() -> None:
    steps = np.diff(changing_times(30.0, np.random.default_rng(0)))
    assert steps.min() > 0.8 / 120 - 1e-9 and steps.max() < 1.2 / 24 + 1e-9
    assert np.std(1 / steps) > 10


def test_the_demo_take_has_its_one_lost_run() -> None:
    take = read_take(BUNDLED)
    assert measure(take)["lost_per_s"] == pytest.approx(1 / take.duration_s)
