"""A moving mesh to other programs: glTF with morph targets, USD with points over time, or an npz of vertices."""

from __future__ import annotations

import io
import json
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from engine.errors import FormatError
from engine.formats.base.atomic import write_bytes
from engine.formats.characters import usd
from engine.formats.characters.moving import MovingMesh

TOLERANCE = 1e-4  # of the mesh's size: what leaving a morph target out may move a vertex by
MOST_TARGETS = 200
ENDINGS = (".glb", *usd.ENDINGS, ".npz")


def require_ending(path: Path) -> None:
    """Raise `FormatError` for a file that a moving mesh cannot be written to: before the work, not after it."""
    if path.suffix.lower() not in ENDINGS:
        raise FormatError(
            f"{path.name} is not a kind of file that a moving mesh can be in.", f"Use one of: {', '.join(ENDINGS)}."
        )


def write(mesh: MovingMesh, path: Path) -> None:
    """Write a moving mesh to a file of a kind in `ENDINGS`; an existing file is replaced whole or left as it was."""
    require_ending(path)
    ending = path.suffix.lower()
    if ending == ".npz":
        buffer = io.BytesIO()
        np.savez_compressed(buffer, rest=mesh.rest, faces=mesh.triangles, vertices=mesh.frames, fps=mesh.fps)
        write_bytes(path, [buffer.getvalue()])
    elif ending == ".glb":
        write_bytes(path, [_glb(mesh)])
    else:
        usd.write(mesh, path)


def targets(mesh: MovingMesh) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """Return morph targets, (k, n, 3), and their weights, (frames, k), that give the frames to within `TOLERANCE`.

    The fewest possible, by principal components of the displacements (computed frame against frame).
    """
    moved = mesh.frames.reshape(len(mesh.frames), -1) - mesh.rest.astype(np.float32).ravel()
    spread, modes = np.linalg.eigh((moved @ moved.T).astype(np.float64))
    size = float(np.linalg.norm(np.ptp(mesh.rest, axis=0)))
    order = modes[:, ::-1][:, : min(MOST_TARGETS, int((spread > 1e-9 * max(spread[-1], 1e-300)).sum()))]
    for count in range(order.shape[1] + 1):
        kept = order[:, :count]
        shapes = kept.T.astype(np.float32) @ moved
        if np.abs(kept.astype(np.float32) @ shapes - moved).max(initial=0.0) <= TOLERANCE * size:
            break
    strongest = np.maximum(np.abs(kept).max(axis=0, initial=1e-12), 1e-12)
    weights = (kept / strongest).astype(np.float32)
    scaled = (shapes * strongest[:, None]).reshape(kept.shape[1], *mesh.rest.shape)
    return scaled.astype(np.float32), weights


def _glb(mesh: MovingMesh) -> bytes:
    """Return a GLB in metres whose weights play the frames."""
    shapes, weights = targets(mesh)
    data = _Binary()
    position = data.add((mesh.rest / 1000.0).astype("<f4"), bounds=True)
    corners = data.add(mesh.triangles.astype("<u4").ravel())
    morphs = [data.add((shape / 1000.0).astype("<f4"), bounds=True) for shape in shapes]
    primitive: dict[str, Any] = {"attributes": {"POSITION": position}, "indices": corners}
    described: dict[str, Any] = {"primitives": [primitive]}
    scene: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "Retake"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [described],
    }
    if morphs:  # weights on a mesh without targets crash viewers
        primitive["targets"] = [{"POSITION": morph} for morph in morphs]
        described["weights"] = [0.0] * len(morphs)
        described["extras"] = {"targetNames": [f"motion_{number}" for number in range(len(morphs))]}
        times = data.add((np.arange(len(weights)) / mesh.fps).astype("<f4"), bounds=True)
        values = data.add(weights.astype("<f4").ravel())
        sampler = {"input": times, "output": values, "interpolation": "LINEAR"}
        channel = {"sampler": 0, "target": {"node": 0, "path": "weights"}}
        scene["animations"] = [{"samplers": [sampler], "channels": [channel]}]
    scene |= {"buffers": [{"byteLength": len(data.content)}], "bufferViews": data.views, "accessors": data.accessors}
    text = json.dumps(scene).encode()
    return _chunks(text + b" " * (-len(text) % 4), bytes(data.content))


def _chunks(text: bytes, binary: bytes) -> bytes:
    body = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<III", 0x46546C67, 2, 12 + len(body)) + body


class _Binary:
    """The binary chunk as it grows, with the views and accessors into it."""

    def __init__(self) -> None:
        self.content = bytearray()
        self.views: list[dict[str, int]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(self, values: npt.NDArray[Any], *, bounds: bool = False) -> int:
        """Append (count,) or (count, 3) values and return the number of their accessor."""
        self.views.append({"buffer": 0, "byteOffset": len(self.content), "byteLength": values.nbytes})
        self.content += values.tobytes()
        accessor: dict[str, Any] = {
            "bufferView": len(self.views) - 1,
            "componentType": 5125 if values.dtype.kind == "u" else 5126,
            "count": len(values),
            "type": "SCALAR" if values.ndim == 1 else "VEC3",
        }
        if bounds:
            flat = values.reshape(len(values), -1)
            ends: Sequence[tuple[str, npt.NDArray[Any]]] = (("min", flat.min(axis=0)), ("max", flat.max(axis=0)))
            accessor |= {name: [float(value) for value in row] for name, row in ends}
        self.accessors.append(accessor)
        return len(self.accessors) - 1
