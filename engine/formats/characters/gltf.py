"""glTF 2.0, GLB and VRM with morph targets; every size is checked before memory is taken."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from engine.errors import FormatError
from engine.formats.base.budget import BUDGET, Budget
from engine.formats.characters.accessors import Accessors, Structure
from engine.formats.characters.gltf_document import EXPORT, document_of
from engine.formats.characters.gltf_names import target_names
from engine.formats.characters.gltf_scene import Placed, blended, placed_meshes
from engine.formats.characters.raw import MAX_SHAPES, RawCharacter, check
from engine.take import Array
from engine.words import counted

TRIANGLES = 4
UNIT, UP = "m", "y"  # of every glTF file
VERTEX_VALUES = 12  # numbers that a vertex takes beside its shapes, with what is made of it on the way
NODES_PER_SHAPE = 4  # of the budget: so long does one take, however small
BONE_VALUES = 40  # the same where several bones hold it


@dataclass(frozen=True, eq=False)
class _Piece:
    """One primitive in the frame of the scene: vertices, triangles, and deltas by target name."""

    vertices: Array
    triangles: npt.NDArray[np.int32]
    targets: dict[str, npt.NDArray[np.float32]]


def read(path: Path) -> RawCharacter:
    """Read all meshes of a glTF scene as one character; raises `FormatError` with one plain sentence."""
    try:
        document, binary = document_of(path)
        accessors = Accessors(document, binary, path)
        with np.errstate(all="ignore"):  # what is not finite is refused below
            pieces = _pieces(document, accessors, path)
    except FormatError:
        raise
    except (
        TypeError, ValueError, KeyError, IndexError, AttributeError, OverflowError, RecursionError, FloatingPointError,
    ) as error:  # fmt: skip
        raise FormatError(f"{path.name} is damaged or not a glTF 2.0 file.", EXPORT) from error
    return check(_joined(pieces, path))


def _pieces(document: Structure, accessors: Accessors, path: Path) -> list[_Piece]:
    """Return the primitives of all placed meshes, those that share their vertices as one."""
    left, asked = BUDGET, []
    for placed in placed_meshes(document, accessors, path):
        mesh = document["meshes"][placed.mesh]
        for group in _groups(mesh):
            left = _spent(left, group, placed, accessors, path)
            asked.append((mesh, group, placed))
    return [_piece(mesh, group, placed, accessors, path) for mesh, group, placed in asked]


def _groups(mesh: Structure) -> Iterator[list[Structure]]:
    """Yield lists of a mesh's primitives that share their vertices and targets."""
    shared: dict[str, list[Structure]] = {}
    for primitive in mesh.get("primitives") or []:
        if primitive.get("mode") in (None, TRIANGLES) and primitive["attributes"].get("POSITION") is not None:
            shared.setdefault(f"{primitive['attributes']['POSITION']} {primitive.get('targets')}", []).append(primitive)
    yield from shared.values()


def _spent(left: Budget, group: list[Structure], placed: Placed, accessors: Accessors, path: Path) -> Budget:
    """Return what is left of the budget when a group of primitives is read."""
    position = group[0]["attributes"]["POSITION"]
    vertices, shapes = accessors.count(position), len(group[0].get("targets") or [])
    if vertices and not accessors.stored(position):
        raise FormatError(f"{path.name} declares {counted(vertices, 'vertex', 'vertices')} and holds none of them.")
    if shapes > MAX_SHAPES:
        raise FormatError(f"{path.name} has {shapes} shapes: more than can be held.")
    beside = VERTEX_VALUES if placed.bones is None else BONE_VALUES
    corners = sum(accessors.count(part["indices"]) if part.get("indices") is not None else vertices for part in group)
    return left.spend(
        path.name, nodes=NODES_PER_SHAPE * (1 + shapes), values=vertices * (beside + 3 * shapes) + 2 * corners
    )


def _piece(mesh: Structure, group: list[Structure], placed: Placed, accessors: Accessors, path: Path) -> _Piece:
    first = group[0]
    vertices = accessors.vectors(first["attributes"]["POSITION"]).astype(np.float64)
    triangles = [_triangles(primitive, len(vertices), accessors, path) for primitive in group]
    skinned = _bones(first, placed, len(vertices), accessors, path)
    targets = {}
    for name, target in zip(target_names(mesh, first, accessors), first.get("targets") or [], strict=True):
        if target.get("POSITION") is not None:
            delta = accessors.vectors(target["POSITION"], wanted=len(vertices), what=name[:60])
            targets[name] = _turned(delta, placed.matrix, skinned)
    moved = _turned(vertices, placed.matrix, skinned)
    moved += placed.matrix[:3, 3] if skinned is None else skinned[:, :3, 3]
    return _Piece(moved, np.concatenate(triangles), targets)


def _bones(first: Structure, placed: Placed, vertices: int, accessors: Accessors, path: Path) -> Array | None:
    """Return each vertex's matrix, (n, 4, 4), where several bones hold the mesh; none where one matrix does."""
    attributes = first["attributes"]
    if placed.bones is None or attributes.get("JOINTS_0") is None or attributes.get("WEIGHTS_0") is None:
        return None
    if not accessors.count(attributes["JOINTS_0"]) == accessors.count(attributes["WEIGHTS_0"]) == vertices:
        raise FormatError(f"{path.name} has a skin for another number of vertices than its mesh.")
    joints = accessors.joints(attributes["JOINTS_0"])
    if joints.max(initial=0) >= len(placed.bones):
        raise FormatError(f"{path.name} names bone {joints.max()} of a skin with {len(placed.bones)}.")
    shares = accessors.floats(attributes["WEIGHTS_0"], "VEC4", what="skin").astype(np.float64)
    return blended(placed.bones, joints, shares)


def _turned(vectors: npt.NDArray[Any], matrix: Array, skinned: Array | None) -> npt.NDArray[Any]:
    """Return vectors, (n, 3), turned and scaled by one matrix or by each vertex's own, in their own precision."""
    if skinned is not None:
        return np.asarray(np.einsum("nij,nj->ni", skinned[:, :3, :3], vectors), vectors.dtype)
    turn = matrix[:3, :3].T.astype(vectors.dtype)
    return vectors if np.array_equal(turn, np.eye(3)) else np.asarray(vectors @ turn)


def _triangles(primitive: Structure, vertices: int, accessors: Accessors, path: Path) -> npt.NDArray[np.int32]:
    listed = np.arange(vertices) if primitive.get("indices") is None else accessors.indices(primitive["indices"])
    if len(listed) and listed.max() >= vertices:
        raise FormatError(f"{path.name} has a face that names vertex {listed.max()}; the mesh has {vertices}.")
    return listed[: len(listed) // 3 * 3].reshape(-1, 3).astype(np.int32)


def _joined(pieces: list[_Piece], path: Path) -> RawCharacter:
    """Put primitives together; a shape moves every mesh that has a target of its name."""
    total = sum(len(piece.vertices) for piece in pieces)
    names = list(dict.fromkeys(name for piece in pieces for name in piece.targets))
    if not pieces or not total:
        raise FormatError(f"{path.name} holds no mesh.", EXPORT)
    if len(names) > MAX_SHAPES:
        raise FormatError(f"{path.name} has {len(names)} shapes: more than can be held.")
    BUDGET.require(path.name, values=3 * total * len(names))
    starts = np.concatenate([[0], np.cumsum([len(piece.vertices) for piece in pieces])])
    shapes = {}
    for name in names:
        parts = [
            piece.targets.pop(name, None) for piece in pieces
        ]  # given up one by one: both would be twice the memory
        shapes[name] = parts[0] if len(parts) == 1 else _whole(parts, starts)
    triangles = [piece.triangles + np.int32(start) for start, piece in zip(starts, pieces, strict=False)]
    vertices = np.concatenate([piece.vertices for piece in pieces])
    raw = RawCharacter(
        path.stem, vertices, np.concatenate(triangles), {n: d for n, d in shapes.items() if d is not None}
    )
    return replace(raw, unit=UNIT, up=UP)


def _whole(parts: list[npt.NDArray[np.float32] | None], starts: npt.NDArray[np.int64]) -> npt.NDArray[np.float32]:
    whole = np.zeros((starts[-1], 3), np.float32)
    for start, part in zip(starts, parts, strict=False):
        if part is not None:
            whole[start : start + len(part)] = part
    return whole
