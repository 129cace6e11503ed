from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
import trimesh

from engine.errors import FormatError
from engine.formats.characters import read, scans

VERTICES = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [9, 9, 9], [0.1, 0.2, 0.7]], float)
QUAD = (
    "ply\nformat ascii 1.0\nelement vertex 6\nproperty double x\nproperty double y\nproperty double z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    + "".join("{:.17g} {:.17g} {:.17g}\n".format(*row) for row in VERTICES)
    + "4 0 1 2 3\n3 0 1 5\n"
)


def corners(vertices: np.ndarray, faces: np.ndarray) -> set[tuple[tuple[float, ...], ...]]:
    """The triangles by their places, each begun at its least corner."""
    found = set()
    for face in vertices[faces].tolist():
        at = face.index(min(face))
        found.add(tuple(map(tuple, face[at:] + face[:at])))
    return found


def test_a_ply_keeps_its_vertices_in_order_those_no_face_has_too(tmp_path: Path) -> None:
    path = tmp_path / "a.ply"
    path.write_text(QUAD)
    found = scans.read(path)
    np.testing.assert_array_equal(found.vertices, VERTICES)
    assert corners(found.vertices, found.triangles) == corners(VERTICES, np.array([[0, 1, 2], [0, 2, 3], [0, 1, 5]]))
    assert found.shapes == {} and found.name == "a"


@pytest.mark.parametrize("options", [{"file_type": "ply"}, {"file_type": "ply", "encoding": "ascii"}])
def test_both_kinds_of_ply_read_back(tmp_path: Path, options: dict[str, str]) -> None:
    ball = trimesh.creation.icosphere(subdivisions=2)
    path = tmp_path / "ball.ply"
    path.write_bytes(ball.export(**options))
    found = scans.read(path)
    np.testing.assert_allclose(found.vertices, ball.vertices, atol=1e-6)
    np.testing.assert_array_equal(found.triangles, ball.faces)


@pytest.mark.parametrize("kind", ["stl", "stl_ascii"])
def test_an_stl_hangs_together_once_it_is_welded(tmp_path: Path, kind: str) -> None:
    ball = trimesh.creation.icosphere(subdivisions=2)
    path, content = tmp_path / "ball.stl", ball.export(file_type=kind)
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    assert len(scans.read(path).vertices) == 3 * len(ball.faces)
    whole = read(path)
    assert len(whole.vertices) == len(ball.vertices) and len(whole.triangles) == len(ball.faces)
    assert len(whole.split) == 3 * len(ball.faces)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.ply", b""),
        ("a.ply", b"solid"),
        ("a.ply", QUAD.replace("element vertex 6", "element vertex 999999999").encode()),
        ("a.ply", QUAD.replace("element vertex 6", "element vertex -6").encode()),
        ("a.ply", QUAD.replace("element vertex 6", "element vertex six").encode()),
        ("a.ply", QUAD.replace("4 0 1 2 3", "4 0 1 2 77").encode()),
        ("a.ply", QUAD.replace("0 1 5", "0 1 -5").encode()),
        ("a.ply", QUAD.replace("9 9 9", "9 nan 9").encode()),
        ("a.ply", QUAD[: len(QUAD) // 2].encode()),
        ("a.stl", b""),
        ("a.stl", b"\0" * 80 + struct.pack("<I", 2_000_000_000) + b"\0" * 50),
        ("a.stl", b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n"),
    ],
)
def test_what_is_no_mesh_is_refused_in_a_sentence(tmp_path: Path, name: str, content: bytes) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(FormatError, match=r"a(\.ply|\.stl)? "):
        scans.read(path)
