"""glTF 2.0 and GLB with morph targets; pygltflib reads the structure, every size is checked before memory is taken."""

from __future__ import annotations

import json
import struct
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pygltflib

from engine.errors import FormatError
from engine.formats.characters.accessors import Accessors
from engine.formats.characters.raw import MAX_SHAPES, MAX_VERTICES, RawCharacter, check
from engine.formats.content import content_of
from engine.take import Array

MAX_BYTES = 1 << 30
MAX_JSON_BYTES = 64 << 20
MAX_NODES = 100_000
MAX_VALUES = 150_000_000  # numbers in all shapes together: 600 MB
MAGIC, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
TRIANGLES = 4
COMPRESSED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression")
EXPORT = "Export it as glTF 2.0 with morph targets and without compression."


@dataclass(frozen=True, eq=False)
class _Piece:
    """One primitive in the frame of the scene: vertices, triangles, and deltas by target name."""

    vertices: Array
    triangles: npt.NDArray[np.int32]
    targets: dict[str, npt.NDArray[np.float32]]


def read(path: Path) -> RawCharacter:
    """Read all meshes of a glTF scene as one character; raises `FormatError` with one plain sentence."""
    try:
        document, binary = _document(path)
        scene = _structure(document)
        _require_readable(scene, path)
        accessors = Accessors(scene, binary, path)
        pieces = [
            piece
            for mesh, matrix in _placed_meshes(scene, path)
            for piece in _pieces(scene.meshes[mesh], matrix, accessors, path)
        ]
    except FormatError:
        raise
    except (TypeError, ValueError, KeyError, IndexError, AttributeError, OverflowError, RecursionError) as error:
        raise FormatError(f"{path.name} is damaged or not a glTF 2.0 file.", EXPORT) from error
    return check(_joined(pieces, path))


def _structure(document: dict[str, Any]) -> pygltflib.GLTF2:
    with warnings.catch_warnings():  # it warns of every optional field that a file leaves out
        warnings.simplefilter("ignore", RuntimeWarning)
        return pygltflib.GLTF2.from_dict(document, infer_missing=True)


def _document(path: Path) -> tuple[dict[str, Any], bytes]:
    """Return the JSON part and the binary chunk, which may be empty."""
    content = content_of(path, at_most=MAX_BYTES)
    chunks = {JSON_CHUNK: content, BINARY_CHUNK: b""}
    if content[:4] == struct.pack("<I", MAGIC):
        chunks |= dict(_chunks(content, path))
    if len(chunks[JSON_CHUNK]) > MAX_JSON_BYTES:
        raise FormatError(f"{path.name} describes its scene in more than {MAX_JSON_BYTES >> 20} MB.")
    document = json.loads(chunks[JSON_CHUNK].decode("utf-8").rstrip("\x00 "))
    if not isinstance(document, dict) or not str(document.get("asset", {}).get("version", "")).startswith("2"):
        raise FormatError(f"{path.name} is not a glTF 2.0 file.", EXPORT)
    return document, chunks[BINARY_CHUNK]


def _chunks(content: bytes, path: Path) -> Iterator[tuple[int, bytes]]:
    """Yield kind and bytes of the first JSON and binary chunk of a GLB file."""
    place, seen = 12, set()
    while place + 8 <= len(content):
        length, kind = struct.unpack_from("<II", content, place)
        if place + 8 + length > len(content):
            raise FormatError(
                f"{path.name} is cut off: a part declares {length} bytes, {len(content) - place - 8} follow."
            )
        if kind not in seen:
            seen.add(kind)
            yield kind, content[place + 8 : place + 8 + length]
        place += 8 + length
    if JSON_CHUNK not in seen:
        raise FormatError(f"{path.name} is cut off: it holds no description of a scene.")


def _require_readable(scene: pygltflib.GLTF2, path: Path) -> None:
    for extension in scene.extensionsRequired or []:
        if extension in COMPRESSED:
            raise FormatError(f"{path.name} is compressed with {extension}, which Retake does not read.", EXPORT)
    if len(scene.nodes or []) > MAX_NODES:
        raise FormatError(f"{path.name} has {len(scene.nodes)} nodes; at most {MAX_NODES} are read.")


def _placed_meshes(scene: pygltflib.GLTF2, path: Path) -> Iterator[tuple[int, Array]]:
    """Yield each node's mesh with its (4, 4) matrix, column vectors; raises `FormatError` for a node met twice."""
    nodes = scene.nodes or []
    children = {child for node in nodes for child in node.children or []}
    roots = [index for index in range(len(nodes)) if index not in children]
    waiting, seen = [(root, np.eye(4)) for root in reversed(roots)], set()
    while waiting:
        index, parent = waiting.pop()
        if not 0 <= index < len(nodes):
            raise FormatError(f"{path.name} names node {index}; it has {len(nodes)}.")
        if index in seen:
            raise FormatError(f"{path.name} has a node that is its own ancestor or has two parents: number {index}.")
        seen.add(index)
        matrix = parent @ _matrix(nodes[index])
        if nodes[index].mesh is not None:
            if not 0 <= nodes[index].mesh < len(scene.meshes or []):
                raise FormatError(f"{path.name} names mesh {nodes[index].mesh}; it has {len(scene.meshes or [])}.")
            yield nodes[index].mesh, np.eye(4) if nodes[index].skin is not None else matrix
        waiting += [(child, matrix) for child in reversed(nodes[index].children or [])]
    if len(seen) < len(nodes):
        raise FormatError(
            f"{path.name} has a node that is its own ancestor: number {min(set(range(len(nodes))) - seen)}."
        )


def _matrix(node: pygltflib.Node) -> Array:
    if node.matrix:
        return np.array(node.matrix, np.float64).reshape(4, 4).T
    x, y, z, w = np.array(node.rotation or (0, 0, 0, 1), np.float64)
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix = np.eye(4)
    matrix[:3, :3] = turn * np.array(node.scale or (1, 1, 1), np.float64)
    matrix[:3, 3] = node.translation or (0, 0, 0)
    return matrix


def _pieces(mesh: pygltflib.Mesh, matrix: Array, accessors: Accessors, path: Path) -> Iterator[_Piece]:
    """Yield a mesh's primitives, those that share their vertices as one."""
    names = (mesh.extras or {}).get("targetNames") if isinstance(mesh.extras, dict) else None
    shared: dict[str, list[pygltflib.Primitive]] = {}
    for primitive in mesh.primitives:
        if primitive.mode in (None, TRIANGLES) and _position(primitive.attributes) is not None:
            shared.setdefault(f"{_position(primitive.attributes)} {primitive.targets}", []).append(primitive)
    for group in shared.values():
        vertices = accessors.vectors(_position(group[0].attributes))
        triangles = [_triangles(primitive, len(vertices), accessors, path) for primitive in group]
        targets = _targets(group[0], names, len(vertices), accessors, path)
        turn = matrix[:3, :3].T
        yield _Piece(
            vertices @ turn + matrix[:3, 3],
            np.concatenate(triangles),
            {name: delta @ turn.astype(np.float32) for name, delta in targets.items()},
        )


def _position(attributes: Any) -> Any:
    """Return the accessor of the positions; the library gives attributes as an object or as they stand in the file."""
    return attributes.get("POSITION") if isinstance(attributes, dict) else attributes.POSITION


def _triangles(
    primitive: pygltflib.Primitive, vertices: int, accessors: Accessors, path: Path
) -> npt.NDArray[np.int32]:
    listed = np.arange(vertices) if primitive.indices is None else accessors.indices(primitive.indices)
    if len(listed) and listed.max() >= vertices:
        raise FormatError(f"{path.name} has a face that names vertex {listed.max()}; the mesh has {vertices}.")
    return listed[: len(listed) // 3 * 3].reshape(-1, 3).astype(np.int32)


def _targets(
    primitive: pygltflib.Primitive, names: Any, vertices: int, accessors: Accessors, path: Path
) -> dict[str, npt.NDArray[np.float32]]:
    targets = primitive.targets or []
    if len(targets) > MAX_SHAPES or len(targets) * vertices * 3 > MAX_VALUES:
        raise FormatError(f"{path.name} has {len(targets)} shapes of {vertices} vertices: more than can be held.")
    if not isinstance(names, list) or len(names) != len(targets):
        names = [f"target {number}" for number in range(len(targets))]
    found = {}
    for name, target in zip(names, targets, strict=True):
        index = _position(target)
        if index is None:
            continue
        found[str(name)] = accessors.vectors(index, wanted=vertices, what=str(name)[:60]).astype(np.float32)
    return found


def _joined(pieces: list[_Piece], path: Path) -> RawCharacter:
    """Put primitives together; a shape moves every mesh that has a target of its name."""
    total = sum(len(piece.vertices) for piece in pieces)
    names = list(dict.fromkeys(name for piece in pieces for name in piece.targets))
    if not pieces or not total:
        raise FormatError(f"{path.name} holds no mesh.", EXPORT)
    if total > MAX_VERTICES or len(names) > MAX_SHAPES or total * 3 * len(names) > MAX_VALUES:
        raise FormatError(f"{path.name} has {total} vertices and {len(names)} shapes: more than can be held.")
    starts = np.concatenate([[0], np.cumsum([len(piece.vertices) for piece in pieces])])
    shapes = {name: np.zeros((total, 3), np.float32) for name in names}
    for start, piece in zip(starts, pieces, strict=False):
        for name, delta in piece.targets.items():
            shapes[name][start : start + len(delta)] = delta
    triangles = [piece.triangles + np.int32(start) for start, piece in zip(starts, pieces, strict=False)]
    vertices = np.concatenate([piece.vertices for piece in pieces])
    return RawCharacter(path.stem, vertices, np.concatenate(triangles), shapes)
