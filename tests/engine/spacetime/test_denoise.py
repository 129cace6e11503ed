from __future__ import annotations

import numpy as np

from engine.spacetime.denoise import _bands, denoise

RNG = np.random.default_rng(0)


def _motion(frames: int = 400) -> np.ndarray:
    """Faces rest most of the time: each marker moves smoothly in bursts."""
    time = np.arange(frames)[:, None, None]
    bursts = np.clip(np.sin(time / 37 + RNG.uniform(0, 6, (1, 10, 3))) - 0.5, 0, None)
    return 8 * bursts * np.sin(time / 5)


def test_the_bands_are_those_of_the_assembled_matrix() -> None:
    second = np.diff(np.eye(9), 2, axis=0)
    whole = np.eye(9) + 3.5 * second.T @ second
    for above in range(3):
        np.testing.assert_allclose(_bands(9, 3.5)[2 - above, above:], np.diag(whole, above))


def test_noise_is_smoothed_and_a_clean_capture_hardly_changes() -> None:
    clean = _motion()
    noisy = clean + RNG.normal(size=clean.shape)
    error = {name: np.diff(each - clean, axis=0).std() for name, each in (("raw", noisy), ("smooth", denoise(noisy)))}
    assert error["smooth"] < 0.4 * error["raw"]
    assert np.abs(denoise(clean) - clean).max() < 0.1


def test_a_short_capture_is_left_alone() -> None:
    short = RNG.normal(size=(5, 3, 3))
    assert denoise(short) is short
