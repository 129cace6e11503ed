"""What a character file holds before it is ours: a mesh, its named shapes, in its own unit and frame."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from engine.errors import FormatError
from engine.take import Array

MAX_VERTICES = 2_000_000
MAX_SHAPES = 512
FARTHEST = 1e9  # a head of 250 mm in nanometres is not as large


@dataclass(frozen=True, eq=False)
class RawCharacter:
    """A mesh with shapes as its file has them.

    Attributes
    ----------
    name : of the file or folder
    vertices : (n, 3) float64, the file's unit and axes
    triangles : (t, 3) int32
    shapes : the file's name of each shape -> (n, 3) float32 deltas
    notices : sentences about the import that the user should see
    split : (file's vertices,) int32, which of `vertices` each vertex of the file is; empty where they are the same
    split_triangles : (file's triangles, 3) int32, of the file's vertices; empty likewise
    unit, up : what the format prescribes, a key of `frame.UNITS_MM` and a name of `frame.UPS`; empty where it does not
    """

    name: str
    vertices: Array
    triangles: npt.NDArray[np.int32]
    shapes: dict[str, npt.NDArray[np.float32]]
    notices: tuple[str, ...] = ()
    split: npt.NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, np.int32))
    split_triangles: npt.NDArray[np.int32] = field(default_factory=lambda: np.zeros((0, 3), np.int32))
    unit: str = ""
    up: str = ""


def check(raw: RawCharacter) -> RawCharacter:
    """Return the character; raises `FormatError` with the first thing about it that cannot be used."""
    count = len(raw.vertices)
    if not count or not len(raw.triangles):
        raise FormatError(f"{raw.name} holds no mesh.", "A character needs vertices and faces.")
    if not np.isfinite(raw.vertices).all():
        bad = int(np.argwhere(~np.isfinite(raw.vertices))[0, 0])
        raise FormatError(f"{raw.name} has a vertex that is not at a finite place: number {bad}.")
    if raw.triangles.min() < 0 or raw.triangles.max() >= count:
        raise FormatError(f"{raw.name} has a face that names vertex {raw.triangles.max()}; it has {count} vertices.")
    if np.abs(raw.vertices).max() > FARTHEST:
        raise FormatError(f"{raw.name} has a vertex further away than a head can be, in any unit.")
    if np.ptp(raw.vertices, axis=0).max() <= 0:
        raise FormatError(f"{raw.name} has all its vertices at one place.")
    for name, delta in raw.shapes.items():
        if delta.shape != raw.vertices.shape:
            raise FormatError(
                f"{raw.name} has {len(delta)} vertices in its shape {name!r}, {count} in its neutral face."
            )
        if not (np.abs(delta) <= FARTHEST).all():
            raise FormatError(f"{raw.name} has a value that is not a finite number in its shape {name!r}.")
    return raw
