from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from engine import assets, character
from engine.character import Character
from engine.lab.sculpting import clay, head
from engine.take import SHAPE_INDEX, SHAPES, Array

STEPS = (0.25, 0.5, 0.75, 1.0)
INNER_LIPS = [(f"lip_inner_upper{side}", f"lip_inner_lower{side}") for side in ("", "_left", "_right")]
COMBINATIONS = 300


@pytest.fixture(scope="module")
def bundled() -> Character:
    return character.load(assets.SECOND_HEAD)


def pose(face: Character, **weights: float) -> Array:
    """Vertices by the plain sum of deltas, without the limits of `Character.vertices`."""
    points = face.neutral.astype(np.float64)
    for name, weight in weights.items():
        points += weight * face.deltas[SHAPE_INDEX[name]]
    return points


def between(face: Character, points: Array, start: str, end: str) -> float:
    return float(np.linalg.norm(points[face.landmarks[start]] - points[face.landmarks[end]]))


def lip_gap(face: Character, **weights: float) -> float:
    points = pose(face, **weights)
    return max(between(face, points, *pair) for pair in INNER_LIPS)


def facet_normals(face: Character, points: Array) -> Array:
    a, b, c = (points[face.triangles[:, corner]] for corner in range(3))
    return np.cross(b - a, c - a)


def flipped_share(face: Character, **weights: float) -> float:
    rest, posed = facet_normals(face, pose(face)), facet_normals(face, pose(face, **weights))
    lengths = np.linalg.norm(rest, axis=1) * np.linalg.norm(posed, axis=1)
    return float(((rest * posed).sum(axis=1) / (lengths + 1e-12) < -0.5).mean())


def test_has_every_shape_moving_something(bundled: Character) -> None:
    assert (np.abs(bundled.deltas).max(axis=(1, 2)) > 1.0).all()


def test_mesh_is_sound(bundled: Character) -> None:
    count = len(bundled.neutral)
    assert 6000 <= count <= 14000
    assert bundled.triangles.min() >= 0 and bundled.triangles.max() < count
    assert len(np.unique(bundled.triangles)) == count, "a vertex belongs to no triangle"
    assert np.linalg.norm(facet_normals(bundled, pose(bundled)), axis=1).min() >= 1e-4


def test_lips_touch_at_rest(bundled: Character) -> None:
    assert lip_gap(bundled) <= 0.3


@pytest.mark.parametrize("side", ["left", "right"])
def test_blink_closes_without_entering_the_eyeball(bundled: Character, side: str) -> None:
    blink = f"eyeBlink{side.capitalize()}"
    lids = [bundled.landmarks[f"lid_{lid}_{side}"] for lid in ("upper", "lower")]
    closed = pose(bundled, **{blink: 1.0})[lids]
    assert np.linalg.norm(closed[0] - closed[1]) <= 0.5
    centre = clay.EYE_CENTRE * ([10, 10, 10] if side == "left" else [-10, 10, 10])
    for weight in STEPS:
        height = np.linalg.norm(pose(bundled, **{blink: weight})[lids] - centre, axis=1) - 10 * clay.EYE_RADIUS
        assert height.min() >= -0.5


def test_jaw_opens_as_far_as_a_mouth_does(bundled: Character) -> None:
    assert 35 <= between(bundled, pose(bundled, jawOpen=1), *INNER_LIPS[0]) <= 50


@pytest.mark.parametrize("weight", STEPS)
def test_lips_close_at_every_angle_of_the_jaw(bundled: Character, weight: float) -> None:
    assert lip_gap(bundled, jawOpen=weight, mouthClose=weight) <= 2.0


def test_right_mirrors_left(bundled: Character) -> None:
    mirrored = bundled.neutral[bundled.mirror] * [-1, 1, 1]
    assert np.abs(mirrored - bundled.neutral).max() < 1e-3
    for name in SHAPES:
        if name.endswith("Left"):
            left, right = bundled.deltas[SHAPE_INDEX[name]], bundled.deltas[SHAPE_INDEX[name[:-4] + "Right"]]
            assert np.abs(left[bundled.mirror] * [-1, 1, 1] - right).max() < 0.06  # half floats


# mouthClose alone turns the lips inside out; it is drawn no further than the jaw has opened
FREE = [name for name in SHAPES if name != "mouthClose"]


@pytest.mark.parametrize("name", FREE)
def test_no_shape_turns_the_surface_over(bundled: Character, name: str) -> None:
    assert flipped_share(bundled, **{name: 1.0}) < 0.005


def test_no_combination_turns_the_surface_over(bundled: Character) -> None:
    rng = np.random.default_rng(0)
    for _ in range(COMBINATIONS):
        chosen = rng.choice(FREE, rng.integers(2, 7), replace=False)
        weights = {str(name): float(rng.random()) for name in chosen}
        if "jawOpen" in weights:
            weights["mouthClose"] = weights["jawOpen"] * float(rng.random())
        assert flipped_share(bundled, **weights) < 0.005, weights


MONOTONE = [
    (INNER_LIPS[0], 1, ("jawOpen",)),
    (("mouth_left", "mouth_right"), 1, ("mouthSmileLeft", "mouthSmileRight")),
    (("mouth_left", "mouth_right"), -1, ("mouthPucker",)),
    (("lid_upper_left", "lid_lower_left"), -1, ("eyeBlinkLeft",)),
    (("lid_upper_right", "lid_lower_right"), -1, ("eyeBlinkRight",)),
    (("lip_upper", "mouth_left"), 1, ("mouthSmileLeft",)),
    (("lip_upper", "mouth_right"), 1, ("mouthSmileRight",)),
    (("nose_bridge", "lip_upper"), -1, ("mouthUpperUpLeft", "mouthUpperUpRight")),
    (("chin", "lip_lower"), 1, ("mouthRollLower",)),
]


@pytest.mark.parametrize(("landmarks", "sign", "names"), MONOTONE)
def test_control_follows_its_shape(
    bundled: Character, landmarks: tuple[str, str], sign: int, names: tuple[str, ...]
) -> None:
    weights = np.linspace(0, 1, 11)
    lengths = [between(bundled, pose(bundled, **dict.fromkeys(names, w)), *landmarks) for w in weights]
    assert (np.diff(lengths) * sign > 0).all()


def test_bundled_file_is_what_the_program_builds(bundled: Character, tmp_path: Path) -> None:
    path = tmp_path / "head.npz"
    head.build(path)
    built = character.load(path)
    np.testing.assert_array_equal(built.triangles, bundled.triangles)
    np.testing.assert_array_equal(built.mirror, bundled.mirror)
    np.testing.assert_allclose(built.neutral, bundled.neutral, atol=1e-3)
    np.testing.assert_allclose(built.deltas, bundled.deltas, atol=0.04)  # a step of a half float at 40 mm
    np.testing.assert_allclose(built.colours.astype(int), bundled.colours, atol=1)
    assert built.landmarks == bundled.landmarks


def test_saved_character_loads_equal(bundled: Character, tmp_path: Path) -> None:
    path = tmp_path / "head.npz"
    character.save(replace(bundled, name="other"), path)
    again = character.load(path)
    assert again.name == "other"
    np.testing.assert_array_equal(again.neutral, bundled.neutral)
    np.testing.assert_array_equal(again.deltas, bundled.deltas)  # already half floats
    np.testing.assert_array_equal(again.colours, bundled.colours)
    assert again.landmarks == bundled.landmarks
