"""A folder of OBJ files: the neutral face and one file for each shape, all with the same vertices in the same order.

Read by code of our own: the shapes of a head stand and fall with the numbers of its vertices. trimesh makes 257,701
vertices of ICT-FaceKit's 26,719, one for each material, and twice the time (1.1 s for 0.7); with materials off it finds
1,080 of its 52,220 triangles, after 7 s; it knows no tabs, and no line that is at fault.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from engine.errors import FormatError
from engine.formats.base.budget import BUDGET
from engine.formats.base.content import content_of, unread
from engine.formats.characters.names import match_names, plain
from engine.formats.characters.raw import FARTHEST, MAX_SHAPES, MAX_VERTICES, RawCharacter, check
from engine.take import Array
from engine.words import counted

MAX_BYTES = 512 << 20
LINES_PER_NODE = 100  # ten million lines in all: what a head of two million vertices has
NEUTRAL_WORDS = ("neutral", "basis", "base", "rest")


def read(folder: Path) -> RawCharacter:
    """Read every OBJ file of a folder as one character; raises `FormatError` that names the file at fault.

    Where the folder holds none but one folder in it does, as in ICT-FaceKit's download, that folder is read.
    """
    folder, paths = _with_obj(folder)
    if len(paths) > MAX_SHAPES:
        raise FormatError(f"{folder.name} holds {len(paths)} OBJ files; a character has at most {MAX_SHAPES}.")
    neutral_path = _neutral(paths, folder)
    vertices, faces = read_obj(neutral_path)
    BUDGET.require(folder.name, values=3 * len(vertices) * len(paths))
    shapes = {}
    for path in paths:
        if path != neutral_path:
            posed, _ = read_obj(path, with_faces=False)
            if len(posed) != len(vertices):
                count = counted(len(posed), "vertex", "vertices")
                raise FormatError(f"{path.name} has {count}, {neutral_path.name} has {len(vertices)}.")
            shapes[path.stem] = (posed - vertices).astype(np.float32)
    return check(RawCharacter(folder.name, vertices, faces, shapes))


def _with_obj(folder: Path) -> tuple[Path, list[Path]]:
    """Return a folder, or the only one right in it, that holds OBJ files, and these in order."""
    try:
        found = _obj_of(folder)
        if found:
            return folder, found
        inner = [(each, found) for each in folder.iterdir() if each.is_dir() and (found := _obj_of(each))]
    except OSError as error:
        raise unread(folder, error) from error
    if len(inner) == 1:
        return inner[0]
    where = f", but {counted(len(inner), 'folder')} in it do" if inner else ""
    advice = "Choose the folder with one OBJ file for each shape."
    raise FormatError(f"{folder.name} holds no OBJ file{where}.", advice)


def _obj_of(folder: Path) -> list[Path]:
    return sorted(path for path in folder.iterdir() if path.suffix.lower() == ".obj" and path.is_file())


def read_mesh(path: Path) -> RawCharacter:
    """Read one OBJ file as a mesh without shapes."""
    vertices, faces = read_obj(path)
    return check(RawCharacter(path.stem, vertices, faces, {}))


def _neutral(paths: list[Path], folder: Path) -> Path:
    named = [path for path in paths if any(word in plain(path.stem) for word in NEUTRAL_WORDS)]
    if len(named) == 1:
        return named[0]
    rows = match_names(path.stem for path in paths)
    left = [path for path, row in zip(paths, rows, strict=True) if not row.shape]
    if not named and len(left) == 1:
        return left[0]
    found = f"could be any of {', '.join(path.name for path in (named or left)[:4])}" if named or left else "is missing"
    raise FormatError(f"The neutral face in {folder.name} {found}.", "Give it a name that contains 'neutral'.")


def read_obj(path: Path, *, with_faces: bool = True) -> tuple[Array, npt.NDArray[np.int32]]:
    """Return vertices (n, 3) and triangles (t, 3); larger polygons become fans. Raises `FormatError` with the line."""
    content = content_of(path, at_most=MAX_BYTES)
    BUDGET.require(path.name, nodes=content.count(b"\n") // LINES_PER_NODE)
    lines = content.split(b"\n")
    places = [number for number, line in enumerate(lines) if line[:2] in (b"v ", b"v\t")]
    if not places:
        raise FormatError(f"{path.name} holds no vertices.", "Is it an OBJ file?")
    if len(places) > MAX_VERTICES:
        raise FormatError(f"{path.name} has {len(places)} vertices; a character has at most {MAX_VERTICES}.")
    vertices = np.array([_vertex(lines[number], number, path) for number in places])
    if not with_faces:
        return vertices, np.zeros((0, 3), np.int32)
    faces: list[tuple[int, int, int]] = []
    for number, line in enumerate(lines):
        if line[:2] in (b"f ", b"f\t"):
            corners = _corners(line, number, len(vertices), path)
            faces += [(corners[0], corners[i], corners[i + 1]) for i in range(1, len(corners) - 1)]
    return vertices, np.array(faces, np.int32).reshape(-1, 3)


def _vertex(line: bytes, number: int, path: Path) -> tuple[float, float, float]:
    try:
        x, y, z = (float(cell) for cell in line.split()[1:4])
    except ValueError:
        raise FormatError(f"{path.name} has a vertex without three numbers in line {number + 1}.") from None
    if not np.isfinite((x, y, z)).all():
        raise FormatError(f"{path.name} has a value that is not a finite number in line {number + 1}.")
    if max(abs(x), abs(y), abs(z)) > FARTHEST:
        raise FormatError(f"{path.name} has a vertex further away than a head can be in line {number + 1}.")
    return x, y, z


def _corners(line: bytes, number: int, vertices: int, path: Path) -> list[int]:
    try:
        named = [int(cell.split(b"/", 1)[0]) for cell in line.split()[1:]]
    except ValueError:
        raise FormatError(f"{path.name} has a face that is not made of numbers in line {number + 1}.") from None
    corners = [index - 1 if index > 0 else vertices + index for index in named]
    if len(corners) < 3 or 0 in named or not all(0 <= corner < vertices for corner in corners):
        raise FormatError(
            f"{path.name} has a face in line {number + 1} that is not made of the {vertices} vertices of the file."
        )
    return corners
