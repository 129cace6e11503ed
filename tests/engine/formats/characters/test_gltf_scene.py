from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from engine.errors import FormatError
from engine.formats.characters import gltf
from engine.formats.characters.accessors import Accessors
from engine.formats.characters.gltf_scene import blended, placed_meshes
from tests.engine.formats.characters.scenes import JAW, VERTICES, document, glb, with_skin


def test_nodes_place_their_meshes_and_turn_their_shapes(tmp_path: Path) -> None:
    scene, binary = document()
    quarter = [0, 0, np.sqrt(0.5), np.sqrt(0.5)]  # about z: x becomes y
    scene["nodes"] = [
        {"children": [1], "translation": [10, 0, 0]},
        {"mesh": 0, "rotation": quarter, "scale": [2, 2, 2]},
    ]
    raw = gltf.read(glb(tmp_path / "a.glb", scene, binary))
    np.testing.assert_allclose(raw.vertices[1], [10, 2, 0], atol=1e-6)
    np.testing.assert_allclose(raw.shapes["jawOpen"][0], [2, 0, 0], atol=1e-6)


@pytest.mark.parametrize("second_bone", [[0, 0, 0], [0, 1, 0]], ids=["one place", "two places"])
def test_bones_place_the_mesh_that_they_hold(second_bone: list[float], tmp_path: Path) -> None:
    raw = gltf.read(glb(tmp_path / "a.glb", *with_skin(*document(), second_bone)))
    placed = VERTICES * 0.01
    placed[3] += second_bone
    np.testing.assert_allclose(raw.vertices, placed, atol=1e-6)
    np.testing.assert_allclose(raw.shapes["jawOpen"], JAW * 0.01, atol=1e-7)


def test_a_scene_of_many_nodes_opens(tmp_path: Path) -> None:
    scene, binary = document()
    scene["nodes"] += [{"name": str(number)} for number in range(20_000)]
    assert len(gltf.read(glb(tmp_path / "a.glb", scene, binary)).vertices) == 4


def plain_matrix(node: dict) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_quat(node.get("rotation", [0, 0, 0, 1])).as_matrix() @ np.diag(
        node.get("scale", [1, 1, 1])
    )
    matrix[:3, 3] = node.get("translation", [0, 0, 0])
    return matrix


def test_nodes_below_nodes_stand_as_the_product_of_their_motions_says() -> None:
    rng = np.random.default_rng(0)
    nodes = [
        {
            "rotation": Rotation.random(random_state=number).as_quat().tolist(),
            "scale": rng.uniform(0.5, 2, 3).tolist(),
            "translation": rng.normal(0, 9, 3).tolist(),
            "mesh": number,
        }
        for number in range(5)
    ]
    nodes[0]["children"], nodes[2]["children"], nodes[3]["children"] = [2], [3, 1], [4]
    parents = {2: 0, 3: 2, 1: 2, 4: 3}
    nodes[4]["matrix"] = plain_matrix(nodes[4]).T.ravel().tolist()
    found = {
        placed.mesh: placed for placed in placed_meshes({"nodes": nodes, "meshes": [{}] * 5}, NO_NUMBERS, Path("a"))
    }
    assert list(found) == [0, 2, 3, 4, 1]  # as they are met from the roots
    for number in range(5):
        expected, at = plain_matrix(nodes[number]), number
        while at in parents:
            at = parents[at]
            expected = plain_matrix(nodes[at]) @ expected
        np.testing.assert_allclose(found[number].matrix, expected, atol=1e-12)
        assert found[number].bones is None


NO_NUMBERS = Accessors({}, memoryview(b""), Path("a"))


@pytest.mark.parametrize(
    ("scene", "says"),
    [
        ({"nodes": [{"mesh": 2}], "meshes": [{}, {}]}, "names mesh 2; it has 2"),
        ({"nodes": [{"mesh": -1}], "meshes": [{}]}, "names mesh -1"),
        ({"nodes": [{"children": [1]}]}, "names node 1; it has 1"),
        ({"nodes": [{"children": [-1]}, {}]}, "names node -1"),
        ({"nodes": [{}, {"children": [2]}, {"children": [1]}]}, "own ancestor: number 1"),
        ({"nodes": [{"children": [2]}, {"children": [2]}, {}]}, "two parents: number 2"),
        ({"nodes": [{"mesh": 0, "skin": 1}], "meshes": [{}], "skins": [{}]}, "names skin 1; it has 1"),
        ({"nodes": [{"mesh": 0, "skin": 0}], "meshes": [{}], "skins": [{}]}, "bone that is not there"),
        ({"nodes": [{"mesh": 0, "skin": 0}], "meshes": [{}], "skins": [{"joints": [0, 1]}]}, "bone that is not there"),
    ],
)
def test_what_leads_nowhere_is_named(scene: dict, says: str) -> None:
    with pytest.raises(FormatError, match=says):
        list(placed_meshes(scene, NO_NUMBERS, Path("a.glb")))


@pytest.mark.parametrize(("apart", "one_place"), [(0.0, True), (0.9e-5, True), (1.1e-5, False)])
def test_bones_that_agree_are_one(apart: float, one_place: bool) -> None:
    bones = [{"scale": [1, 1, 1]}, {"translation": [apart, 0, 0]}]
    scene = {
        "nodes": [*bones, {"mesh": 0, "skin": 0, "translation": [9, 9, 9]}],
        "meshes": [{}],
        "skins": [{"joints": [0, 1]}],
    }
    (placed,) = placed_meshes(scene, NO_NUMBERS, Path("a.glb"))
    np.testing.assert_array_equal(placed.matrix, np.eye(4))
    assert (placed.bones is None) == one_place
    scene["nodes"][0]["scale"] = [1e13, 1, 1]
    with pytest.raises(FormatError, match="places its mesh nowhere"):
        list(placed_meshes(scene, NO_NUMBERS, Path("a.glb")))


def test_a_vertex_between_bones_goes_with_the_mean_of_their_matrices_by_its_shares() -> None:
    rng = np.random.default_rng(1)
    bones, joints, shares = rng.normal(size=(3, 4, 4)), rng.integers(0, 3, (6, 4)), rng.random((6, 4)) * 3
    found = blended(bones, joints, shares)
    for vertex in range(6):
        plain = sum(share * bones[joint] for share, joint in zip(shares[vertex], joints[vertex], strict=True))
        np.testing.assert_allclose(found[vertex], plain / shares[vertex].sum())
    assert not blended(bones, joints, shares * 0).any()
