from __future__ import annotations

import numpy as np
import pytest

from engine.clean.lag import lag_ms


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


def test_only_shapes_that_move_in_both_are_asked() -> None:
    times = np.arange(300) / 60
    waves = np.sin(times[:, None] * [3.0, 4.0, 5.0])
    late = np.sin((times[:, None] - 0.05) * [3.0, 4.0, 5.0])
    late[:, 1] *= 0.02  # hardly moves
    late[:, 2] = np.sin(7 * times)
    waves[:, 2] *= 0.04
    assert lag_ms(late, waves, times) == pytest.approx(50.0, abs=1.0)
    waves[:, 2] *= 2
    assert lag_ms(late, waves, times) != pytest.approx(50.0, abs=1.0)


@pytest.mark.parametrize(("length_s", "told"), [(0.7, False), (1.0, True)])
def test_what_is_shorter_than_all_lags_that_are_looked_for_tells_none(length_s: float, told: bool) -> None:
    times = np.arange(0, length_s, 1 / 60)
    waves = np.sin(9 * times)[:, None]
    assert np.isfinite(lag_ms(waves, waves, times)) == told


def test_a_lag_beyond_a_fifth_of_a_second_is_not_looked_for() -> None:
    times = np.arange(600) / 60
    bump = np.exp(-(((times - 5) / 0.1) ** 2))[:, None]
    later = np.exp(-(((times - 5.19) / 0.1) ** 2))[:, None]
    assert lag_ms(later, bump, times) == pytest.approx(190, abs=1.5)
    assert lag_ms(bump, later, times) == pytest.approx(-190, abs=1.5)
