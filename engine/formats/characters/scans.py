"""Single meshes of scanners and sculpting programs, PLY and STL, read by trimesh: a head without shapes.

trimesh believes the counts that a file declares; they are compared with what it holds before it is asked.
"""

from __future__ import annotations

import io
import re
import warnings
from pathlib import Path

import numpy as np

from engine.errors import FormatError
from engine.formats.base.budget import BUDGET
from engine.formats.base.content import content_of
from engine.formats.characters.raw import MAX_VERTICES, RawCharacter, check

ENDINGS = (".ply", ".stl")
MAX_BYTES = 512 << 20
LONGEST_HEADER = 64 * 1024
STL_TRIANGLE = 50  # bytes
_DECLARED = re.compile(rb"^element\s+\S+\s+(\S+)", re.MULTILINE)


def read(path: Path) -> RawCharacter:
    """Return a mesh without shapes; polygons of a PLY become fans. Raises `FormatError` with one plain sentence."""
    content = content_of(path, at_most=MAX_BYTES)
    kind = path.suffix.lower().removeprefix(".")
    _require_sound(content, path, kind)
    return check(RawCharacter(path.stem, *_arrays(content, path, kind), {}))


def _arrays(content: bytes, path: Path, kind: str) -> tuple[np.ndarray, np.ndarray]:
    import trimesh

    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            # In the file's own order: landmarks and edits name vertices by their number.
            mesh = trimesh.load_mesh(io.BytesIO(content), file_type=kind, process=False)
        vertices, faces = np.array(mesh.vertices, np.float64), np.array(mesh.faces, np.int64)
        if vertices.shape[1:] != (3,) or faces.shape[1:] != (3,):
            raise ValueError("no triangles")
    except Exception as error:  # a damaged file fails anywhere in trimesh, with whatever numpy or Python raise there
        raise FormatError(f"{path.name} could not be read as {kind.upper()}.", "Is the file whole?") from error
    if len(faces) and not 0 <= faces.min() <= faces.max() < len(vertices):
        raise FormatError(f"{path.name} has a face that is not made of the {len(vertices)} vertices of the file.")
    return vertices, faces.astype(np.int32)


def _require_sound(content: bytes, path: Path, kind: str) -> None:
    """Raise `FormatError` for a file that declares more than it can hold, or more than a character has."""
    counts = _counts_of_ply(content, path) if kind == "ply" else _counts_of_stl(content)
    if sum(counts) > len(content):
        raise FormatError(f"{path.name} declares {sum(counts):,} parts and ends before them.", "Is the file whole?")
    if max(counts, default=0) > 3 * MAX_VERTICES:
        raise FormatError(f"{path.name} has {max(counts):,} parts; a character has at most {MAX_VERTICES:,} vertices.")
    BUDGET.require(path.name, values=16 * sum(counts))


def _counts_of_ply(content: bytes, path: Path) -> list[int]:
    head, end, _ = content[:LONGEST_HEADER].partition(b"end_header")
    if not head.startswith(b"ply") or not end:
        raise FormatError(f"{path.name} is not a PLY file.", "Its first line is 'ply', and 'end_header' follows.")
    try:
        counts = [int(count) for count in _DECLARED.findall(head)]
    except ValueError:
        counts = [-1]
    if not counts or min(counts) < 0:
        raise FormatError(f"{path.name} does not say how many vertices and faces it has.")
    return counts


def _counts_of_stl(content: bytes) -> list[int]:
    if content[:5].lower() == b"solid" and b"facet" in content[:LONGEST_HEADER]:
        return [content.count(b"vertex")]
    return [len(content) // STL_TRIANGLE]  # trimesh itself compares the number in the header with the length
