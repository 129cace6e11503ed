from __future__ import annotations

import base64
import json
import struct
from pathlib import Path

import numpy as np
import pytest

from engine.errors import FormatError
from engine.formats.characters import gltf
from engine.formats.characters.accessors import Accessors
from tests.engine.formats.characters.scenes import JAW, document, glb


def test_a_text_file_with_an_embedded_or_neighbouring_buffer_reads_the_same(tmp_path: Path) -> None:
    scene, binary = document()
    scene["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(binary).decode()
    (tmp_path / "embedded.gltf").write_text(json.dumps(scene))
    scene["buffers"][0]["uri"] = "my%20buffer.bin"
    (tmp_path / "my buffer.bin").write_bytes(binary)
    (tmp_path / "beside.gltf").write_text(json.dumps(scene))
    for name in ("embedded.gltf", "beside.gltf"):
        np.testing.assert_array_equal(gltf.read(tmp_path / name).shapes["jawOpen"], JAW)


def test_a_value_that_is_not_finite_is_refused(tmp_path: Path) -> None:
    scene, binary = document()
    with pytest.raises(FormatError, match="not a finite number"):
        gltf.read(glb(tmp_path / "a.glb", scene, struct.pack("<f", np.nan) + binary[4:]))


def accessors(
    values: np.ndarray, kind: str = "VEC3", *, offset: int = 0, stride: int | None = None, **more: object
) -> Accessors:
    """Return accessors whose first reads values out of a buffer of its own."""
    component = {np.dtype(name): number for number, name in COMPONENTS.items()}[values.dtype]
    rows = values.reshape(len(values), -1)
    width = rows.shape[1] * values.dtype.itemsize
    step = stride or width
    data = bytearray(b"\xaa" * (offset + step * len(rows)))
    for at, row in enumerate(rows):
        data[offset + at * step : offset + at * step + width] = row.tobytes()
    view = {"buffer": 0, "byteOffset": 0, "byteLength": len(data), **({"byteStride": stride} if stride else {})}
    entry = {
        "bufferView": 0,
        "byteOffset": offset,
        "componentType": component,
        "count": len(rows),
        "type": kind,
        **more,
    }
    scene = {"buffers": [{"byteLength": len(data)}], "bufferViews": [view], "accessors": [entry]}
    return Accessors(scene, memoryview(bytes(data)), Path("a.glb"))


COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
RNG = np.random.default_rng(0)


@pytest.mark.parametrize("component", COMPONENTS.values())
@pytest.mark.parametrize(("offset", "stride"), [(0, None), (8, None), (4, 24)])
def test_numbers_of_every_kind_are_read_where_they_lie(component: str, offset: int, stride: int | None) -> None:
    values = (RNG.random((7, 3)) * 100).astype(component)
    found = accessors(values, offset=offset, stride=stride)
    np.testing.assert_array_equal(found.vectors(0, wanted=7), values.astype(np.float32))
    assert found.count(0) == 7 and found.stored(0) and found.name(0) == ""


@pytest.mark.parametrize(("component", "largest"), [("<i1", 127), ("<u1", 255), ("<i2", 32767), ("<u2", 65535)])
def test_whole_numbers_that_stand_for_shares_are_divided_down(component: str, largest: int) -> None:
    low = np.iinfo(component).min
    values = np.array([[0, largest, low]], component)
    expected = [0, 1, -1 if low else 0]
    np.testing.assert_array_equal(accessors(values, normalized=True).floats(0, "VEC3", what="x")[0], expected)
    np.testing.assert_array_equal(accessors(values).floats(0, "VEC3", what="x")[0], values[0])
    halves = accessors(np.array([[0.25, -3, 9]], np.float32), normalized=True).floats(0, "VEC3", what="x")
    np.testing.assert_array_equal(halves, [[0.25, -3, 9]])


def test_corners_and_joints_are_whole_numbers_that_are_not_negative() -> None:
    corners = np.array([0, 5, 65535], "<u2")
    np.testing.assert_array_equal(accessors(corners, "SCALAR").indices(0), corners)
    joints = np.array([[0, 1, 2, 255]], "<u1")
    np.testing.assert_array_equal(accessors(joints, "VEC4").joints(0), joints)
    for values, kind, read in ((corners.astype("<i2"), "SCALAR", "indices"), (joints.astype("<f4"), "VEC4", "joints")):
        with pytest.raises(FormatError, match="form that cannot be read"):
            getattr(accessors(values, kind), read)(0)
    for read in ("indices", "joints"):
        with pytest.raises(FormatError, match="wrong kind"):
            getattr(accessors(RNG.random((3, 3)).astype("<f4")), read)(0)


def test_sparse_values_are_put_over_what_lies_below() -> None:
    values = np.arange(12, dtype="<f4").reshape(4, 3)
    where, put_there = np.array([3, 1], "<u1"), np.array([[-1, -2, -3], [-4, -5, -6]], "<f4")
    data = values.tobytes() + where.tobytes() + b"\0\0" + put_there.tobytes()
    views = [{"buffer": 0, "byteOffset": start, "byteLength": size} for start, size in ((0, 48), (48, 2), (52, 24))]
    sparse = {"count": 2, "indices": {"bufferView": 1, "componentType": 5121}, "values": {"bufferView": 2}}
    entry = {"componentType": 5126, "count": 4, "type": "VEC3", "sparse": sparse}
    for below, expected in (({"bufferView": 0}, values.copy()), ({}, np.zeros((4, 3)))):
        scene = {"buffers": [{"byteLength": len(data)}], "bufferViews": views, "accessors": [{**entry, **below}]}
        expected[[3, 1]] = put_there
        found = Accessors(scene, memoryview(data), Path("a.glb"))
        np.testing.assert_array_equal(found.vectors(0), expected)
        assert found.stored(0) == bool(below)
        for count, says in ((5, "corrects as many values as 5 of 4"), (-1, "as many values as -1")):
            sparse["count"] = count
            with pytest.raises(FormatError, match=says):
                found.vectors(0)
        sparse["count"] = 2
    broken = Accessors(scene, memoryview(data.replace(b"\x03\x01", b"\x04\x01")), Path("a.glb"))
    with pytest.raises(FormatError, match="corrects value 4 of 4"):
        broken.vectors(0)


@pytest.mark.parametrize(
    ("keys", "value", "says"),
    [
        (("accessors", 0, "count"), 8, "declares 96 bytes of numbers in a buffer view of 84"),
        (("bufferViews", 0, "byteLength"), 83, "declares 84 bytes of numbers in a buffer view of 83"),
        (("bufferViews", 0, "byteLength"), 85, "ends at byte 85 of a buffer of 84"),
        (("bufferViews", 0, "byteOffset"), 1, "ends at byte 85"),
        (("bufferViews", 0, "byteOffset"), -1, "impossible size"),
        (("bufferViews", 0, "byteStride"), 11, "impossible size"),
        (("accessors", 0, "byteOffset"), 1, "declares 85 bytes"),
        (("accessors", 0, "byteOffset"), -1, "impossible size"),
        (("accessors", 0, "byteOffset"), 0.5, "not a whole number"),
        (("accessors", 0, "bufferView"), 1, "names buffer view 1; it has 1"),
        (("accessors", 0, "bufferView"), -1, "names buffer view -1"),
        (("bufferViews", 0, "buffer"), 1, "names buffer 1; it has 1"),
        (("bufferViews", 0, "buffer"), True, "names buffer True"),
        (("buffers", 0, "byteLength"), 85, "declares a buffer of 85 bytes and holds 84"),
        (("buffers", 0, "uri"), 7, "whose place is no text"),
        (("buffers", 0, "uri"), "data:;base64,!", "not valid base64"),
        (("accessors", 0, "componentType"), 5124, "unknown kind: 5124"),
        (("accessors", 0, "count"), -1, "wrong kind: number 0"),
        (("accessors", 0, "count"), True, "wrong kind"),
        (("accessors", 0, "type"), "VEC4", "wrong kind"),
    ],
)
def test_what_leads_out_of_the_file_is_named(keys: tuple[object, ...], value: object, says: str) -> None:
    found = accessors(RNG.random((7, 3)).astype("<f4"))
    place = found._scene
    for key in keys[:-1]:
        place = place[key]
    place[keys[-1]] = value
    with pytest.raises(FormatError, match=says):
        found.vectors(0)
    for index in (-1, 1, "0", True):
        with pytest.raises(FormatError, match="names accessor"):
            found.count(index)


def test_as_many_vectors_as_wanted_and_none_where_none_are() -> None:
    found = accessors(RNG.random((7, 3)).astype("<f4"))
    with pytest.raises(FormatError, match="has 7 vertices in its shape 'jaw', 6 in its mesh"):
        found.vectors(0, wanted=6, what="jaw")
    found._scene["accessors"][0]["count"] = 0
    assert found.vectors(0).shape == (0, 3)
    found._scene["accessors"][0]["count"] = 2_000_001
    with pytest.raises(FormatError, match="declares 2000001 vertices"):
        found.vectors(0)
