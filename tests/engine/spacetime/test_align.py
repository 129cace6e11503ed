from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from engine.errors import EditError
from engine.spacetime.align import HeadMotion, Warp, check_points, procrustes, stillest
from engine.take import Array

RNG = np.random.default_rng(0)
FACE = RNG.normal(size=(20, 3)) * [60, 80, 30]
NAMES = [f"m{index}" for index in range(20)]


def _motion(frames: int = 30) -> HeadMotion:
    rotations = Rotation.from_rotvec(RNG.normal(size=(frames, 3)) * 0.7).as_matrix()
    return HeadMotion(rotations, 100 * RNG.normal(size=(frames, 3)))


def test_a_rigid_motion_is_found_and_removed_exactly() -> None:
    motion = _motion()
    seen = motion.apply(np.repeat(FACE[None], 30, axis=0))
    for found in (procrustes(seen, FACE), stillest(seen, FACE)):
        np.testing.assert_allclose(found.rotations, motion.rotations, atol=1e-9)
        np.testing.assert_allclose(found.remove(seen), np.broadcast_to(FACE, seen.shape), atol=1e-9)


def test_a_rigid_motion_is_found_through_gaps() -> None:
    motion = _motion()
    seen = motion.apply(np.repeat(FACE[None], 30, axis=0))
    seen[RNG.random((30, 20)) < 0.4] = np.nan
    np.testing.assert_allclose(procrustes(seen, FACE).translations, motion.translations, atol=1e-9)


def test_a_mirrored_face_is_turned_never_reflected() -> None:
    found = procrustes((FACE * [-1, 1, 1])[None], FACE)
    assert np.linalg.det(found.rotations[0]) == pytest.approx(1)


def test_removing_and_applying_head_motion_are_inverse() -> None:
    motion, face = _motion(), RNG.normal(size=(30, 20, 3))
    np.testing.assert_allclose(motion.remove(motion.apply(face)), face, atol=1e-9)


def test_angles_rebuild_the_rotation() -> None:
    motion = _motion()
    rebuilt = Rotation.from_euler("YXZ", motion.angles() * [-1, 1, -1]).as_matrix()
    np.testing.assert_allclose(rebuilt, motion.rotations, atol=1e-9)


@pytest.mark.parametrize(
    ("column", "axis", "degrees"),
    [(0, [0, 1, 0], -20), (1, [1, 0, 0], 20), (2, [0, 0, 1], -20)],
    ids=["to the character's right", "down", "to the left shoulder"],
)
def test_turns_have_the_signs_of_live_link_face(column: int, axis: list[int], degrees: float) -> None:
    """With X to the character's left, Y up and Z to the front: where nose and crown go tells which turn it was."""
    turn = Rotation.from_rotvec(np.radians(degrees) * np.array(axis)).as_matrix()
    nose, crown = turn @ [0, 0, 1], turn @ [0, 1, 0]
    assert [-nose[0], -nose[1], crown[0]][column] > 0.3
    angles = procrustes((FACE @ turn.T)[None], FACE).angles()[0]
    np.testing.assert_allclose(np.degrees(angles), 20 * np.eye(3)[column], atol=1e-9)


def test_a_moving_jaw_does_not_turn_the_head() -> None:
    frames = 200
    face = np.repeat(FACE[None], frames, axis=0)
    face[:, :6, 1] -= 20 * (1 - np.cos(np.arange(frames) / 9))[:, None] / 2
    face += 0.05 * RNG.normal(size=face.shape)
    motion = _motion(frames)
    seen = motion.apply(face)
    plain, still = (find(seen, FACE) for find in (procrustes, stillest))

    def degrees(found: HeadMotion) -> float:
        turned = Rotation.from_matrix(found.rotations @ motion.rotations.transpose(0, 2, 1))
        return float(np.degrees(turned.magnitude()).mean())

    assert degrees(still) < 0.1 * degrees(plain)


def test_the_warp_hits_its_points_and_is_exact_on_affine_maps() -> None:
    affine, shift = RNG.normal(size=(3, 3)), 50 * RNG.normal(size=3)
    others = 100 * RNG.normal(size=(7, 5, 3))
    warp = Warp(FACE, FACE @ affine.T + shift, NAMES)
    np.testing.assert_allclose(warp(others), others @ affine.T + shift, atol=1e-9 * 200)
    images = FACE + RNG.normal(size=FACE.shape)
    np.testing.assert_allclose(Warp(FACE, images, NAMES)(FACE), images, atol=1e-9)


def _broken(kind: str) -> Array:
    points = FACE.copy()
    if kind == "missing":
        points[[3, 7]] = np.nan
    elif kind == "duplicate":
        points[4] = points[11]
    elif kind == "plane":
        points[:, 2] = 0.2 * points[:, 0] + 3
    elif kind == "line":
        points = np.outer(np.arange(20), [1.0, 2.0, 3.0])
    return points


@pytest.mark.parametrize(
    ("kind", "says"),
    [
        ("missing", "m3, m7 are missing"),
        ("duplicate", "m4 and m11 are at the same place"),
        ("plane", "m0, m1.* in one plane"),
        ("line", "m0, m1.* on one line"),
    ],
)
def test_degenerate_markers_are_named(kind: str, says: str) -> None:
    with pytest.raises(EditError, match=says):
        check_points(_broken(kind), NAMES)


def test_a_frame_without_enough_markers_is_named() -> None:
    seen = np.repeat(FACE[None], 5, axis=0)
    seen[3, 2:] = np.nan
    with pytest.raises(EditError, match="frame 3 only 2 markers"):
        procrustes(seen, FACE)
    seen[3] = np.outer(np.arange(20), [1.0, 2.0, 3.0])
    with pytest.raises(EditError, match=r"frame 3 .* one line"):
        procrustes(seen, FACE)
