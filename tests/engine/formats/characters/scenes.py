"""Small glTF scenes."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

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


def with_skin(scene: dict[str, Any], binary: bytes, second_bone: list[float]) -> tuple[dict[str, Any], bytes]:
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


def put(*keys: Any) -> Callable[[dict[str, Any]], None]:
    """Return a change of the document: all but the last of `keys` lead to a place, the last is put there."""

    def change(scene: dict[str, Any]) -> None:
        place: Any = scene
        for key in keys[:-2]:
            place = place[key]
        place[keys[-2]] = keys[-1]

    return change
