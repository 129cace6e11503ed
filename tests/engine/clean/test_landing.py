from __future__ import annotations

import numpy as np

from engine.clean.landing import Landing, advance, still

JUMP = np.array([0.5, -0.2], np.float32)
REST = np.zeros(2, np.float32)


def landed(fps: float, gap_s: float, seconds: float) -> np.ndarray:
    """Offsets after a gap that ends with a jump of the estimate, frame by frame."""
    landing = still(2)
    for _ in range(round(gap_s * fps)):
        landing = advance(landing, REST, REST, 1 / fps, present=False)
    landing = advance(landing, JUMP, REST, 1 / fps, present=True)
    offsets = [landing.offset]
    for _ in range(round(seconds * fps)):
        landing = advance(landing, REST, REST, 1 / fps, present=True)
        offsets.append(landing.offset)
    return np.array(offsets)


def test_without_a_gap_nothing_is_added() -> None:
    landing = advance(still(2), JUMP, JUMP, 1 / 60, present=True)
    assert not landing.offset.any()


def test_a_landing_begins_where_the_bridge_was_and_dies_away() -> None:
    offsets = landed(120.0, 1.0, 2.0)
    np.testing.assert_allclose(offsets[0], -JUMP, rtol=0.05)
    assert np.abs(np.diff(offsets, axis=0)).max() < 0.1 * np.abs(JUMP).max()
    assert not offsets[-1].any()


def test_a_single_lost_frame_is_hardly_felt() -> None:
    assert np.abs(landed(60.0, 1 / 60, 0.1)[1:]).max() < 0.1 * np.abs(JUMP).max()


def test_the_rate_does_not_matter() -> None:
    slow, fast = landed(30.0, 1.0, 1.0), landed(120.0, 1.0, 1.0)
    np.testing.assert_allclose(slow[:30], fast[3::4][:30], atol=1e-4)


def test_a_gap_during_a_landing_goes_on_from_it() -> None:
    landing = Landing(JUMP, REST)
    moved = advance(landing, REST, REST, 1 / 60, present=False)
    assert (np.abs(moved.offset) < np.abs(JUMP)).all() and (moved.offset * JUMP > 0).all()
