from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from engine.character import bundled
from engine.errors import EditError
from engine.manifold.drive import MeshDriver, Settings, parts_of
from engine.manifold.placement import place_points
from engine.take import SHAPE_INDEX, SHAPES


def pose(**weights: float) -> np.ndarray:
    asked = np.zeros(len(SHAPES))
    for name, value in weights.items():
        asked[SHAPE_INDEX[name]] = value
    return bundled().vertices(asked).astype(float)


@lru_cache(maxsize=1)
def skin_points() -> np.ndarray:
    head = bundled()
    skin = parts_of(head.triangles, len(head.neutral)) == 0
    motions = head.deltas[::3].astype(float)
    return place_points(head.neutral.astype(float), head.triangles, motions, 80, allowed=skin)


@lru_cache(maxsize=1)
def driver() -> MeshDriver:
    return MeshDriver(pose(), bundled().triangles, skin_points())


TURN = Rotation.from_euler("xyz", [25, -40, 10], degrees=True).as_matrix()


@pytest.mark.parametrize(
    "matrix", [TURN, 1.7 * TURN, TURN @ np.diag([-1.0, 1, 1])], ids=["rigid", "scaled", "mirrored"]
)
def test_a_common_motion_of_the_points_is_that_motion_of_the_whole_mesh(matrix: np.ndarray) -> None:
    moved = pose() @ matrix.T + [30, -200, 5]
    made = driver().drive(moved[None, skin_points()])[0]
    assert np.abs(made - moved).max() < 1e-6 * np.ptp(moved, axis=0).max()


def test_an_expression_commutes_with_a_turn_of_the_head() -> None:
    smile = pose(mouthSmileLeft=1, browInnerUp=0.5)[skin_points()]
    still = driver().drive(smile[None])[0]
    turned = driver().drive((smile @ TURN.T + 7)[None])[0]
    np.testing.assert_allclose(turned, still @ TURN.T + 7, atol=1e-6)


def test_the_points_land_where_they_are_asked_to() -> None:
    asked = pose(jawOpen=1, mouthPucker=0.4)[skin_points()]
    made = driver().drive(asked[None])[0]
    assert np.abs(made[skin_points()] - asked).max() < 0.05


def test_an_open_mouth_does_not_glue() -> None:
    head = bundled()
    made = driver().drive(pose(jawOpen=1)[None, skin_points()])[0]
    true, rest = pose(jawOpen=1), pose()
    for side in ("", "_left", "_right"):
        upper, lower = (head.landmarks[f"lip_inner_{which}{side}"] for which in ("upper", "lower"))
        gap, wanted, before = (np.linalg.norm(v[upper] - v[lower]) for v in (made, true, rest))
        assert gap > 0.7 * wanted and gap > before + 8


def test_eyes_and_teeth_keep_their_form_and_stay_with_the_head() -> None:
    head = bundled()
    parts = parts_of(head.triangles, len(head.neutral))
    moved = pose(jawOpen=0.5, browInnerUp=1) @ TURN.T + [0, 50, 0]
    made = driver().drive(moved[None, skin_points()])[0]
    for part in range(1, parts.max() + 1):
        own = parts == part
        rest, after = (v[own] - v[own].mean(axis=0) for v in (pose(), made))
        np.testing.assert_allclose(np.linalg.norm(after, axis=1), np.linalg.norm(rest, axis=1), rtol=0.02)
    eyes = (parts == 1) | (parts == 2)
    assert np.linalg.norm(made[eyes] - moved[eyes], axis=1).mean() < 1.5


def test_missing_markers_are_bridged_and_too_few_are_refused() -> None:
    asked = pose(mouthSmileLeft=1)[skin_points()]
    gappy = asked.copy()
    gappy[::10] = np.nan
    whole, bridged = driver().drive(np.stack([asked, gappy]))
    assert np.linalg.norm(whole - bridged, axis=1).mean() < 0.5
    gappy[3:] = np.nan
    with pytest.raises(EditError, match="only"):
        driver().drive(gappy[None])


@pytest.mark.parametrize(
    ("points", "says"),
    [
        (np.arange(3), "too few"),
        (np.array([0, 1, 2, 10**6]), "names vertex 1000000"),
        (np.array([0, 100, 200, 300, 300]), "twice"),
    ],
)
def test_unusable_points_are_named(points: np.ndarray, says: str) -> None:
    with pytest.raises(EditError, match=says):
        MeshDriver(pose(), bundled().triangles, points)


def test_a_point_twice_is_told_how_to_be_mended() -> None:
    with pytest.raises(EditError) as told:
        MeshDriver(pose(), bundled().triangles, np.array([0, 100, 200, 300, 300]))
    assert told.value.sentence == "Vertex 300 is a feature point twice." and "fewer points" in told.value.advice


def test_points_in_one_plane_are_refused() -> None:
    flat = np.c_[np.random.default_rng(0).random((30, 2)), np.zeros(30)]
    triangles = np.arange(30).reshape(-1, 3)
    with pytest.raises(EditError, match="one plane"):
        MeshDriver(flat, triangles, np.arange(6))


def test_another_number_of_markers_is_refused() -> None:
    with pytest.raises(EditError, match="the mesh has 80"):
        driver().drive(np.zeros((2, 12, 3)))


def test_the_paper_s_own_settings_are_exact_on_common_motions_too() -> None:
    plain = MeshDriver(pose(), bundled().triangles, skin_points(), Settings(dimension=3, stiffness=0.0))
    moved = pose() @ (2 * TURN).T
    assert np.abs(plain.drive(moved[None, skin_points()])[0] - moved).max() < 1e-6 * np.ptp(moved, axis=0).max()
