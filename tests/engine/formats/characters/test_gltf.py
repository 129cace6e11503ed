from __future__ import annotations

import base64
import json
import struct
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from engine.errors import FormatError
from engine.formats.characters import gltf, read

VERTICES = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
FACES = np.array([[0, 1, 2], [0, 2, 3]], np.uint16)
JAW = np.array([[0, -1, 0], [0, 0, 0], [0, 0, 0], [0, -0.5, 0.25]], np.float32)


def document() -> tuple[dict[str, Any], bytes]:
    """A small scene, (JSON, binary): four vertices, two faces, two shapes, the second one sparse."""
    where, moved = np.array([2], np.uint16), np.array([[0.5, 0, 0]], np.float32)
    parts = [VERTICES.tobytes(), FACES.tobytes(), JAW.tobytes(), where.tobytes() + b"\0\0", moved.tobytes()]
    starts = np.cumsum([0, *map(len, parts)]).tolist()
    views = [{"buffer": 0, "byteOffset": s, "byteLength": len(p)} for s, p in zip(starts, parts, strict=False)]
    corrected = {
        "count": 1,
        "indices": {"bufferView": 3, "componentType": 5123},
        "values": {"bufferView": 4},
    }
    scene = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": starts[-1]}],
        "bufferViews": views,
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"componentType": 5126, "count": 4, "type": "VEC3", "sparse": corrected},
        ],
        "meshes": [
            {
                "primitives": [
                    {"attributes": {"POSITION": 0}, "indices": 1, "targets": [{"POSITION": 2}, {"POSITION": 3}]}
                ],
                "extras": {"targetNames": ["jawOpen", "mouthSmile_L"]},
            }
        ],
        "nodes": [{"mesh": 0}],
    }
    return scene, b"".join(parts)


def glb(path: Path, scene: dict[str, Any], binary: bytes) -> Path:
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    return path


def test_mesh_and_shapes_are_read_dense_and_sparse(tmp_path: Path) -> None:
    raw = gltf.read(glb(tmp_path / "a.glb", *document()))
    np.testing.assert_array_equal(raw.vertices, VERTICES)
    np.testing.assert_array_equal(raw.triangles, FACES)
    assert list(raw.shapes) == ["jawOpen", "mouthSmile_L"]
    np.testing.assert_array_equal(raw.shapes["jawOpen"], JAW)
    np.testing.assert_array_equal(raw.shapes["mouthSmile_L"], [[0, 0, 0], [0, 0, 0], [0.5, 0, 0], [0, 0, 0]])


def test_a_text_file_with_an_embedded_or_neighbouring_buffer_reads_the_same(tmp_path: Path) -> None:
    scene, binary = document()
    scene["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(binary).decode()
    (tmp_path / "embedded.gltf").write_text(json.dumps(scene))
    scene["buffers"][0]["uri"] = "my%20buffer.bin"
    (tmp_path / "my buffer.bin").write_bytes(binary)
    (tmp_path / "beside.gltf").write_text(json.dumps(scene))
    for name in ("embedded.gltf", "beside.gltf"):
        np.testing.assert_array_equal(gltf.read(tmp_path / name).shapes["jawOpen"], JAW)


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


def test_meshes_that_share_a_shape_s_name_move_together(tmp_path: Path) -> None:
    scene, binary = document()
    scene["nodes"] = [{"mesh": 0}, {"mesh": 0, "translation": [5, 0, 0]}]
    raw = gltf.read(glb(tmp_path / "a.glb", scene, binary))
    assert len(raw.vertices) == 8 and raw.triangles.max() == 7
    np.testing.assert_array_equal(raw.shapes["jawOpen"], np.concatenate([JAW, JAW]))


PLACES_OF_NAMES: dict[str, Callable[[dict[str, Any]], None]] = {
    "mesh": lambda mesh: mesh.update(extras={"targetNames": ["jawOpen", "mouthSmileLeft"]}),
    "primitive": lambda mesh: mesh["primitives"][0].update(extras={"targetNames": ["jawOpen", "mouthSmileLeft"]}),
    "target": lambda mesh: [
        target.update(extras={"name": name})
        for target, name in zip(mesh["primitives"][0]["targets"], ("jawOpen", "mouthSmileLeft"), strict=True)
    ],
    "too few in the mesh": lambda mesh: (
        mesh.update(extras={"targetNames": ["jawOpen"]}),
        mesh["primitives"][0].update(extras={"targetNames": ["other", "mouthSmileLeft"]}),
    ),
}


@pytest.mark.parametrize("place", PLACES_OF_NAMES)
@pytest.mark.parametrize("ending", ["glb", "vrm"])
def test_shapes_are_named_wherever_a_program_wrote_their_names(place: str, ending: str, tmp_path: Path) -> None:
    scene, binary = document()
    del scene["meshes"][0]["extras"]
    PLACES_OF_NAMES[place](scene["meshes"][0])
    raw = read(glb(tmp_path / f"a.{ending}", scene, binary))
    assert list(raw.shapes) == ["jawOpen", "mouthSmileLeft"]
    np.testing.assert_array_equal(raw.shapes["jawOpen"], JAW)


def test_shapes_are_named_by_their_accessors_where_nothing_else_names_them(tmp_path: Path) -> None:
    scene, binary = document()
    del scene["meshes"][0]["extras"]
    scene["accessors"][2]["name"] = "jawOpen"
    assert list(gltf.read(glb(tmp_path / "a.glb", scene, binary)).shapes) == ["jawOpen", "target 1"]


def test_two_shapes_of_one_name_are_both_kept(tmp_path: Path) -> None:
    scene, binary = document()
    scene["meshes"][0]["extras"]["targetNames"] = ["jawOpen", "jawOpen"]
    assert list(gltf.read(glb(tmp_path / "a.glb", scene, binary)).shapes) == ["jawOpen", "jawOpen #2"]


def _with_skin(scene: dict[str, Any], binary: bytes, second_bone: list[float]) -> tuple[dict[str, Any], bytes]:
    """Bones that scale a mesh in cm to a scene in m; the last vertex hangs on a second bone."""
    binds = np.array([np.diag([0.01, 0.01, 0.01, 1.0])] * 2, np.float32)
    joints = np.array([[0, 0, 0, 0]] * 3 + [[1, 0, 0, 0]], np.uint8)
    shares = np.array([[1, 0, 0, 0]] * 4, np.float32)
    for values, kind, component in ((binds, "MAT4", 5126), (joints, "VEC4", 5121), (shares, "VEC4", 5126)):
        start = len(binary)
        binary += values.tobytes()
        scene["bufferViews"].append({"buffer": 0, "byteOffset": start, "byteLength": values.nbytes})
        view = len(scene["bufferViews"]) - 1
        scene["accessors"].append({"bufferView": view, "componentType": component, "count": len(values), "type": kind})
    first = len(scene["accessors"]) - 3
    scene["buffers"][0]["byteLength"] = len(binary)
    scene["meshes"][0]["primitives"][0]["attributes"] |= {"JOINTS_0": first + 1, "WEIGHTS_0": first + 2}
    scene["skins"] = [{"joints": [1, 2], "inverseBindMatrices": first}]
    scene["nodes"] = [{"mesh": 0, "skin": 0, "translation": [50, 0, 0]}, {}, {"translation": second_bone}]
    return scene, binary


@pytest.mark.parametrize("second_bone", [[0, 0, 0], [0, 1, 0]], ids=["one place", "two places"])
def test_bones_place_the_mesh_that_they_hold(second_bone: list[float], tmp_path: Path) -> None:
    raw = gltf.read(glb(tmp_path / "a.glb", *_with_skin(*document(), second_bone)))
    placed = VERTICES * 0.01
    placed[3] += second_bone
    np.testing.assert_allclose(raw.vertices, placed, atol=1e-6)
    np.testing.assert_allclose(raw.shapes["jawOpen"], JAW * 0.01, atol=1e-7)


def test_a_scene_of_many_nodes_opens(tmp_path: Path) -> None:
    scene, binary = document()
    scene["nodes"] += [{"name": str(number)} for number in range(20_000)]
    assert len(gltf.read(glb(tmp_path / "a.glb", scene, binary)).vertices) == 4


def _set(*keys: Any) -> Callable[[dict[str, Any]], None]:
    """Return a change of the document: all but the last of `keys` lead to a place, the last is put there."""

    def change(scene: dict[str, Any]) -> None:
        place: Any = scene
        for key in keys[:-2]:
            place = place[key]
        place[keys[-2]] = keys[-1]

    return change


HOSTILE = {
    "view beyond its buffer": (_set("bufferViews", 2, "byteOffset", 5000), "ends at byte"),
    "view of another buffer": (_set("bufferViews", 0, "buffer", 7), "names buffer 7"),
    "count beyond the view": (_set("accessors", 1, "count", 60), "declares 120 bytes"),
    "count times stride overflows": (_set("bufferViews", 0, "byteStride", 2**62), "declares"),
    "count overflows": (_set("accessors", 0, "count", 2**63), "at most"),
    "two gigabytes of nothing": (
        _set("accessors", 0, {"componentType": 5126, "count": 178956970, "type": "VEC3"}),
        "holds none of them",
    ),
    "two gigabytes of corners": (
        _set("accessors", 1, {"componentType": 5125, "count": 2**29, "type": "SCALAR"}),
        "at most",
    ),
    "buffer larger than the file": (_set("buffers", 0, "byteLength", 2**31), "declares a buffer"),
    "negative offset": (_set("bufferViews", 0, "byteOffset", -12), "impossible size"),
    "index beyond the vertices": (_set("accessors", 0, "count", 3), "names vertex 3"),
    "target of another length": (_set("accessors", 2, "count", 3), "3 vertices in its shape 'jawOpen'"),
    "a node its own child": (_set("nodes", [{"children": [0], "mesh": 0}]), "own ancestor"),
    "a ring of nodes": (_set("nodes", [{"mesh": 0}, {"children": [2]}, {"children": [1], "mesh": 0}]), "own ancestor"),
    "a node with two parents": (_set("nodes", [{"children": [2]}, {"children": [2]}, {"mesh": 0}]), "two parents"),
    "a child that is not there": (_set("nodes", [{"children": [9]}]), "names node 9"),
    "a mesh that is not there": (_set("nodes", [{"mesh": 4}]), "names mesh 4"),
    "a path out of the folder": (_set("buffers", 0, "uri", "../secret.bin"), "outside its folder"),
    "an escaped path out of the folder": (_set("buffers", 0, "uri", "%2e%2e/secret.bin"), "outside its folder"),
    "an absolute path": (_set("buffers", 0, "uri", "/etc/passwd"), "outside its folder"),
    "an address": (_set("buffers", 0, "uri", "http://127.0.0.1:9/a.bin"), "opens no addresses"),
    "a file address": (_set("buffers", 0, "uri", "file:///etc/passwd"), "opens no addresses"),
    "a sparse index beyond": (_set("accessors", 3, "sparse", "count", 5), "as many values as 5"),
    "compressed": (_set("extensionsRequired", ["KHR_draco_mesh_compression"]), "compressed"),
    "text for a number": (_set("accessors", 0, "count", "many"), "damaged|wrong kind"),
    "no mesh": (_set("nodes", []), "holds no mesh"),
    "an old version": (_set("asset", {"version": "1.0"}), "not a glTF 2.0"),
    "lists for objects": (_set("meshes", [[], []]), "damaged"),
    "a hundred meshes of nothing": (
        lambda scene: scene.update(
            nodes=[{"mesh": 0}] * 100,
            accessors=[{"componentType": 5126, "count": 2_000_000, "type": "VEC3"}],
            meshes=[{"primitives": [{"attributes": {"POSITION": 0}}]}],
        ),
        "holds none of them",
    ),
    "a mesh a thousand times": (
        lambda scene: scene.update(
            nodes=[{"mesh": 0}] * 9_000,
            meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "targets": [{"POSITION": 2}] * 500}]}],
        ),
        "at most",
    ),
    "more nodes than a scene has": (_set("nodes", [{}] * 300_000), "at most"),
    "a skin of bones that are not there": (
        lambda scene: scene.update(nodes=[{"mesh": 0, "skin": 0}], skins=[{"joints": [7]}]),
        "bone that is not there",
    ),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_gets_one_sentence_and_little_memory(name: str, tmp_path: Path) -> None:
    (tmp_path / "secret.bin").write_bytes(document()[1])
    change, says = HOSTILE[name]
    scene, binary = document()
    change(scene)
    (tmp_path / "inside").mkdir()
    path = glb(tmp_path / "inside" / "bad.glb", scene, binary)
    tracemalloc.start()
    with pytest.raises(FormatError, match=says):
        gltf.read(path)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 32e6


def test_a_value_that_is_not_finite_is_refused(tmp_path: Path) -> None:
    scene, binary = document()
    with pytest.raises(FormatError, match="not a finite number"):
        gltf.read(glb(tmp_path / "a.glb", scene, struct.pack("<f", np.nan) + binary[4:]))


def test_many_shapes_on_one_buffer_do_not_multiply_memory(tmp_path: Path) -> None:
    scene, binary = document()
    scene["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": 2}] * 2_000
    with pytest.raises(FormatError, match="more than can be held"):
        gltf.read(glb(tmp_path / "a.glb", scene, binary))


@pytest.mark.parametrize("keep", [0, 3, 12, 20, 300])
def test_a_cut_off_file_is_refused(keep: int, tmp_path: Path) -> None:
    path = glb(tmp_path / "a.glb", *document())
    path.write_bytes(path.read_bytes()[:keep])
    with pytest.raises(FormatError):
        gltf.read(path)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(place=st.integers(0, 4000), value=st.integers(0, 255))
def test_any_changed_byte_gives_a_character_or_a_sentence(place: int, value: int, tmp_path: Path) -> None:
    path = glb(tmp_path / "a.glb", *document())
    content = bytearray(path.read_bytes())
    content[place % len(content)] = value
    path.write_bytes(bytes(content))
    try:
        gltf.read(path)
    except FormatError as error:
        assert "\n" not in str(error)


def _places(part: Any) -> list[tuple[Any, Any]]:
    """Return every container and key of a document, however deep."""
    keys = list(part) if isinstance(part, dict) else range(len(part)) if isinstance(part, list) else []
    return [(part, key) for key in keys] + [place for key in keys for place in _places(part[key])]


WHOLE = st.sampled_from([-1, 0, 1, 2, 7, 255, 2**16, 2**31 - 1, 2**31, 2**53, 2**63, 2**64, 10**30])
STRANGE = st.one_of(
    WHOLE,
    st.sampled_from(
        [None, True, 0.5, -1e308, float("nan"), float("inf"), "", "0", "../../x", "data:;base64,!", [], {}]
    ),
    st.lists(st.lists(WHOLE, max_size=2), max_size=2),
)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(changes=st.lists(st.tuples(st.integers(0, 10_000), STRANGE), min_size=1, max_size=3))
def test_any_changed_value_gives_a_character_or_a_sentence_and_little_memory(
    changes: list[tuple[int, Any]], tmp_path: Path
) -> None:
    scene, binary = document()
    for number, value in changes:
        places = _places(scene)
        if places:
            part, key = places[number % len(places)]
            part[key] = value
    path = glb(tmp_path / "a.glb", scene, binary)
    tracemalloc.start()
    try:
        gltf.read(path)
    except FormatError as error:
        assert "\n" not in str(error) and len(str(error)) < 400
    finally:
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    assert peak < 64e6
