from __future__ import annotations

import numpy as np

from engine.easing import ease


def test_the_step_is_smooth_symmetric_and_stays_at_its_ends() -> None:
    at = np.linspace(0, 1, 101)
    eased = ease(at)
    np.testing.assert_allclose(eased[[0, 25, 50, 75, 100]], [0, 5 / 32, 0.5, 27 / 32, 1])
    np.testing.assert_allclose(eased + ease(1 - at), 1)
    assert (np.diff(eased) > 0).all()
    np.testing.assert_allclose(np.gradient(eased, at)[[0, -1]], 0, atol=0.04)
    np.testing.assert_array_equal(ease(np.array([-5.0, -1e-9, 1 + 1e-9, 7.0])), [0, 0, 1, 1])
