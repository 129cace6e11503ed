"""The columns of a Live Link Face CSV, found by their names and never by their position."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from engine.errors import FormatError
from engine.formats.livelink.sides import recorded_name
from engine.take import SHAPE_INDEX, SHAPES
from engine.words import counted

ROTATIONS = (
    "HeadYaw",
    "HeadPitch",
    "HeadRoll",
    *(f"{s}Eye{a}" for s in ("Left", "Right") for a in ("Yaw", "Pitch", "Roll")),
)
ROTATION_INDEX = {name: index for index, name in enumerate(ROTATIONS)}
DEFAULT_HEADER = ("Timecode", "BlendshapeCount", *(f"{name[0].upper()}{name[1:]}" for name in SHAPES), *ROTATIONS)
KNOWN = {name.lower() for name in (*SHAPES, *ROTATIONS)}
EXPECTED = "Retake reads the CSV files that Live Link Face records."
Places = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Columns:
    """Which cells of a row hold which of a take's values.

    Attributes
    ----------
    shapes, shape_cells : (n,) index into `SHAPES`, and the cell of a row that holds it
    rotations, rotation_cells : (m,) index into `ROTATIONS`, and the cell that holds it
    """

    shapes: Places
    shape_cells: Places
    rotations: Places
    rotation_cells: Places

    @property
    def cells(self) -> Places:
        """The cells that hold numbers of a take, rising; what stands in others is the file's own affair."""
        return np.sort(np.concatenate([self.shape_cells, self.rotation_cells]))


def column_name(cell: str) -> str:
    """Return the name of a column without case and separators, its side in full: `Eye_Blink_L` is `eyeblinkleft`."""
    lower = re.sub(r"[_ ]l$", "left", re.sub(r"[_ ]r$", "right", cell.strip().lower()))
    return re.sub(r"[\s_-]", "", lower)


def columns_of(header: tuple[str, ...], name: str, *, swapped: bool) -> Columns:
    """Return where the values of a take stand; raises `FormatError`, which calls the file by its `name`.

    With `swapped`, left and right of mouth and jaw stand under each other's names.
    """
    names = [column_name(cell) for cell in header]
    if names[:2] != ["timecode", "blendshapecount"]:
        raise FormatError(f"{name} does not begin with the header of a Live Link Face take.", EXPECTED)
    ours = [(cell, index) for index, cell in enumerate(names) if cell in KNOWN]
    found = dict(ours)
    if len(found) != len(ours):
        raise FormatError(f"{name} names a column twice in its first row.")
    missing = [shape for shape in SHAPES if shape.lower() not in found and shape != "tongueOut"]
    if missing:
        raise FormatError(f"{name} lacks the column {missing[0]} ({counted(len(missing), 'shape')} missing).", EXPECTED)
    shapes = [(SHAPE_INDEX[recorded_name(shape, swapped=swapped)], shape.lower()) for shape in SHAPES]
    rotations = [(index, rotation.lower()) for rotation, index in ROTATION_INDEX.items()]
    pairs = [[(index, found[cell]) for index, cell in group if cell in found] for group in (shapes, rotations)]
    arrays = [np.array(pair, np.int64).reshape(-1, 2).T for pair in pairs]
    return Columns(*arrays[0], *arrays[1])
