from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from engine.manifold.pose import Poses, fit_similarity

RNG = np.random.default_rng(0)
REST = RNG.normal(size=(30, 3)) * [60, 80, 40]


def poses(frames: int = 6, mirror: bool = False) -> Poses:
    turn = Rotation.random(frames, random_state=1).as_matrix()
    if mirror:
        turn = turn * np.array([-1.0, 1, 1])[:, None]
    return Poses(turn, RNG.uniform(0.5, 2, frames), RNG.normal(0, 100, (frames, 3)))


@pytest.mark.parametrize("mirror", [False, True])
def test_a_common_motion_is_found_and_undone_exactly(mirror: bool) -> None:
    true = poses(mirror=mirror)
    moved = true.apply(REST)
    for frame in range(6):
        np.testing.assert_allclose(moved[frame], true.scale[frame] * REST @ true.turn[frame] + true.shift[frame])
    found = fit_similarity(REST, moved)
    np.testing.assert_allclose(found.turn, true.turn, atol=1e-9)
    np.testing.assert_allclose(found.scale, true.scale)
    np.testing.assert_allclose(found.shift, true.shift, atol=1e-7)
    np.testing.assert_allclose(found.undo(moved), np.broadcast_to(REST, moved.shape), atol=1e-9)
    again = fit_similarity(np.broadcast_to(REST, moved.shape), moved)
    np.testing.assert_allclose(again.turn, found.turn, atol=1e-12)


def test_what_a_third_of_the_points_do_on_their_own_turns_nothing() -> None:
    true = poses()
    moved = true.apply(REST)
    moved[:, :10] += RNG.normal(0, 40, (6, 10, 3))
    found = fit_similarity(REST, moved)
    np.testing.assert_allclose(found.turn, true.turn, atol=1e-6)
    np.testing.assert_allclose(found.scale, true.scale, rtol=1e-6)


def test_without_size_or_mirror_images_neither_is_found() -> None:
    true = poses(mirror=True)
    moved = true.apply(REST)
    assert (fit_similarity(REST, moved, scaled=False).scale == 1).all()
    turned = fit_similarity(REST, moved, mirrored=False)
    np.testing.assert_allclose(np.linalg.det(turned.turn), 1)
    np.testing.assert_allclose(np.linalg.det(fit_similarity(REST, moved).turn), -1)
    flat = REST * [1, 1, 0]  # flat points do not tell a mirror image from a turned one
    np.testing.assert_allclose(np.linalg.det(fit_similarity(flat, poses().apply(flat)).turn), 1)


def test_points_at_one_place_keep_their_size() -> None:
    found = fit_similarity(REST * 0, np.zeros((2, 30, 3)) + 5)
    assert (found.scale == 1).all() and np.isfinite(found.turn).all()
    np.testing.assert_allclose(found.shift, 5)
