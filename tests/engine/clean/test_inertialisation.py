from __future__ import annotations

import numpy as np

from engine.clean.inertialisation import Inertialisation, advance, no_offset

JUMP = np.array([0.5, -0.2], np.float32)
REST = np.zeros(2, np.float32)


def offsets_after(fps: float, gap_s: float, seconds: float) -> np.ndarray:
    """Offsets after a gap that ends with a jump of the estimate, frame by frame."""
    state = no_offset(2)
    for _ in range(round(gap_s * fps)):
        state = advance(state, REST, REST, 1 / fps, present=False)
    state = advance(state, JUMP, REST, 1 / fps, present=True)
    offsets = [state.offset]
    for _ in range(round(seconds * fps)):
        state = advance(state, REST, REST, 1 / fps, present=True)
        offsets.append(state.offset)
    return np.array(offsets)


def test_without_a_gap_nothing_is_added() -> None:
    state = advance(no_offset(2), JUMP, JUMP, 1 / 60, present=True)
    assert not state.offset.any()


def test_the_offset_begins_where_the_bridge_was_and_dies_away() -> None:
    offsets = offsets_after(120.0, 1.0, 2.0)
    np.testing.assert_allclose(offsets[0], -JUMP, rtol=0.05)
    assert np.abs(np.diff(offsets, axis=0)).max() < 0.1 * np.abs(JUMP).max()
    assert not offsets[-1].any()


def test_a_single_lost_frame_is_hardly_felt() -> None:
    assert np.abs(offsets_after(60.0, 1 / 60, 0.1)[1:]).max() < 0.1 * np.abs(JUMP).max()


def test_the_rate_does_not_matter() -> None:
    slow, fast = offsets_after(30.0, 1.0, 1.0), offsets_after(120.0, 1.0, 1.0)
    np.testing.assert_allclose(slow[:30], fast[3::4][:30], atol=1e-4)


def test_a_gap_during_a_decay_goes_on_from_it() -> None:
    state = Inertialisation(JUMP, REST)
    moved = advance(state, REST, REST, 1 / 60, present=False)
    assert (np.abs(moved.offset) < np.abs(JUMP)).all() and (moved.offset * JUMP > 0).all()
