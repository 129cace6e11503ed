"""Where a glTF scene puts its meshes: nodes below nodes, and skins whose bones hold the vertices."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from engine.errors import FormatError
from engine.formats.characters.accessors import Accessors, Structure
from engine.take import Array

ALIKE = 1e-5  # of a bone's matrix: below this all bones hold the mesh in one place


@dataclass(frozen=True, eq=False)
class Placed:
    """A mesh of the scene.

    Attributes
    ----------
    mesh : its number
    matrix : (4, 4), column vectors, from the mesh to the scene; where bones hold it, of a bone that all agree with
    bones : (joints, 4, 4) where the bones hold its vertices at different places; none otherwise
    """

    mesh: int
    matrix: Array
    bones: Array | None = None


def placed_meshes(scene: Structure, accessors: Accessors, path: Path) -> Iterator[Placed]:
    """Yield each node's mesh; raises `FormatError` for a node that is met twice or is not there."""
    nodes = scene.get("nodes") or []
    matrices = _world(nodes, path)
    meshes = scene.get("meshes") or []
    for index, matrix in matrices.items():
        mesh = nodes[index].get("mesh")
        if mesh is None:
            continue
        if type(mesh) is not int or not 0 <= mesh < len(meshes):
            raise FormatError(f"{path.name} names mesh {str(mesh)[:20]}; it has {len(meshes)}.")
        if nodes[index].get("skin") is None:
            yield Placed(mesh, matrix)
        else:
            yield _skinned(mesh, nodes[index]["skin"], scene, matrices, accessors, path)


def _world(nodes: list[Structure], path: Path) -> dict[int, Array]:
    """Return each node's matrix from its own frame to the scene's, in the order in which they are met from the roots."""
    children = {child for node in nodes for child in node.get("children") or []}
    waiting = [(index, np.eye(4)) for index in reversed(range(len(nodes))) if index not in children]
    found: dict[int, Array] = {}
    while waiting:
        index, parent = waiting.pop()
        if type(index) is not int or not 0 <= index < len(nodes):
            raise FormatError(f"{path.name} names node {str(index)[:20]}; it has {len(nodes)}.")
        if index in found:
            raise FormatError(f"{path.name} has a node that is its own ancestor or has two parents: number {index}.")
        found[index] = parent @ _matrix(nodes[index])
        waiting += [(child, found[index]) for child in reversed(nodes[index].get("children") or [])]
    if len(found) < len(nodes):
        missed = min(set(range(len(nodes))) - set(found))
        raise FormatError(f"{path.name} has a node that is its own ancestor: number {missed}.")
    return found


def _matrix(node: Structure) -> Array:
    if node.get("matrix"):
        return np.array(node["matrix"], np.float64).reshape(4, 4).T
    x, y, z, w = np.array(node.get("rotation") or (0, 0, 0, 1), np.float64)
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix = np.eye(4)
    matrix[:3, :3] = turn * np.array(node.get("scale") or (1, 1, 1), np.float64)
    matrix[:3, 3] = node.get("translation") or (0, 0, 0)
    return matrix


def _skinned(
    mesh: int, skin: Any, scene: Structure, matrices: dict[int, Array], accessors: Accessors, path: Path
) -> Placed:
    """Return a mesh that bones hold: each takes it from the mesh to the bone by its inverse bind matrix, and to the scene."""
    skins = scene.get("skins") or []
    if type(skin) is not int or not 0 <= skin < len(skins):
        raise FormatError(f"{path.name} names skin {str(skin)[:20]}; it has {len(skins)}.")
    joints = skins[skin].get("joints") or []
    if not joints or any(type(joint) is not int or joint not in matrices for joint in joints):
        raise FormatError(f"{path.name} has a skin with a bone that is not there.")
    bones = np.array([matrices[joint] for joint in joints])
    inverse = skins[skin].get("inverseBindMatrices")
    if inverse is not None:
        if accessors.count(inverse) < len(joints):
            raise FormatError(f"{path.name} has a skin with fewer matrices than bones.")
        flat = accessors.floats(inverse, "MAT4", what="skin")[: len(joints)].astype(np.float64)
        bones = bones @ flat.reshape(-1, 4, 4).transpose(0, 2, 1)
    if not (np.abs(bones) < 1e12).all():
        raise FormatError(f"{path.name} has a skin that places its mesh nowhere.")
    size = max(float(np.abs(bones).max()), 1e-12)
    alike = float(np.abs(bones - bones[0]).max()) <= ALIKE * size
    return Placed(mesh, bones[0], None if alike else bones)


def blended(bones: Array, joints: Array, shares: Array) -> Array:
    """Return each vertex's matrix, (n, 4, 4), of bones (j, 4, 4) held by joints (n, 4) with shares (n, 4) each."""
    total = np.maximum(shares.sum(axis=1, keepdims=True), 1e-12)
    return np.asarray(np.einsum("nk,nkij->nij", shares / total, bones[joints]))
