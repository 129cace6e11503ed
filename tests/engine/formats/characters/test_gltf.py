from __future__ import annotations

import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from engine.errors import FormatError
from engine.formats.characters import gltf
from tests.engine.formats.characters.scenes import FACES, JAW, VERTICES, document, glb, put


def test_mesh_and_shapes_are_read_dense_and_sparse(tmp_path: Path) -> None:
    raw = gltf.read(glb(tmp_path / "a.glb", *document()))
    np.testing.assert_array_equal(raw.vertices, VERTICES)
    np.testing.assert_array_equal(raw.triangles, FACES)
    assert list(raw.shapes) == ["jawOpen", "mouthSmile_L"]
    np.testing.assert_array_equal(raw.shapes["jawOpen"], JAW)
    np.testing.assert_array_equal(raw.shapes["mouthSmile_L"], [[0, 0, 0], [0, 0, 0], [0.5, 0, 0], [0, 0, 0]])


def test_meshes_that_share_a_shape_s_name_move_together(tmp_path: Path) -> None:
    scene, binary = document()
    scene["nodes"] = [{"mesh": 0}, {"mesh": 0, "translation": [5, 0, 0]}]
    raw = gltf.read(glb(tmp_path / "a.glb", scene, binary))
    assert len(raw.vertices) == 8 and raw.triangles.max() == 7
    np.testing.assert_array_equal(raw.shapes["jawOpen"], np.concatenate([JAW, JAW]))


HOSTILE = {
    "view beyond its buffer": (put("bufferViews", 2, "byteOffset", 5000), "ends at byte"),
    "view of another buffer": (put("bufferViews", 0, "buffer", 7), "names buffer 7"),
    "count beyond the view": (put("accessors", 1, "count", 60), "declares 120 bytes"),
    "count times stride overflows": (put("bufferViews", 0, "byteStride", 2**62), "declares"),
    "count overflows": (put("accessors", 0, "count", 2**63), "at most"),
    "two gigabytes of nothing": (
        put("accessors", 0, {"componentType": 5126, "count": 178956970, "type": "VEC3"}),
        "holds none of them",
    ),
    "two gigabytes of corners": (
        put("accessors", 1, {"componentType": 5125, "count": 2**29, "type": "SCALAR"}),
        "at most",
    ),
    "buffer larger than the file": (put("buffers", 0, "byteLength", 2**31), "declares a buffer"),
    "negative offset": (put("bufferViews", 0, "byteOffset", -12), "impossible size"),
    "index beyond the vertices": (put("accessors", 0, "count", 3), "names vertex 3"),
    "target of another length": (put("accessors", 2, "count", 3), "3 vertices in its shape 'jawOpen'"),
    "a node its own child": (put("nodes", [{"children": [0], "mesh": 0}]), "own ancestor"),
    "a ring of nodes": (put("nodes", [{"mesh": 0}, {"children": [2]}, {"children": [1], "mesh": 0}]), "own ancestor"),
    "a node with two parents": (put("nodes", [{"children": [2]}, {"children": [2]}, {"mesh": 0}]), "two parents"),
    "a child that is not there": (put("nodes", [{"children": [9]}]), "names node 9"),
    "a mesh that is not there": (put("nodes", [{"mesh": 4}]), "names mesh 4"),
    "a path out of the folder": (put("buffers", 0, "uri", "../secret.bin"), "outside its folder"),
    "an escaped path out of the folder": (put("buffers", 0, "uri", "%2e%2e/secret.bin"), "outside its folder"),
    "an absolute path": (put("buffers", 0, "uri", "/etc/passwd"), "outside its folder"),
    "an address": (put("buffers", 0, "uri", "http://127.0.0.1:9/a.bin"), "opens no addresses"),
    "a file address": (put("buffers", 0, "uri", "file:///etc/passwd"), "opens no addresses"),
    "a sparse index beyond": (put("accessors", 3, "sparse", "count", 5), "as many values as 5"),
    "compressed": (put("extensionsRequired", ["KHR_draco_mesh_compression"]), "compressed"),
    "text for a number": (put("accessors", 0, "count", "many"), "damaged|wrong kind"),
    "no mesh": (put("nodes", []), "holds no mesh"),
    "an old version": (put("asset", {"version": "1.0"}), "not a glTF 2.0"),
    "lists for objects": (put("meshes", [[], []]), "damaged"),
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
    "more nodes than a scene has": (put("nodes", [{}] * 300_000), "at most"),
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


def test_many_shapes_on_one_buffer_do_not_multiply_memory(tmp_path: Path) -> None:
    scene, binary = document()
    scene["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": 2}] * 2_000
    with pytest.raises(FormatError, match="more than can be held"):
        gltf.read(glb(tmp_path / "a.glb", scene, binary))


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
