"""The file that a take came from as parts to keep, and back: what a project stores of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from engine.formats.livelink.columns import columns_of
from engine.formats.livelink.origin import MAX_HEADER_BYTES, Origin, header_of, row_starts
from engine.take import Mask, Take


@dataclass(frozen=True, eq=False)
class Packed:
    """All of an `Origin` that its take does not hold.

    Attributes
    ----------
    content : the file as it came
    rows : (rows,) the take's frame that each row became, rising from 0 to the last
    lost : (rows,) bool, rows without a face
    swapped : whether left and right of mouth and jaw were exchanged on import
    """

    content: bytes
    rows: npt.NDArray[np.int64]
    lost: Mask
    swapped: bool


def pack(take: Take) -> Packed | None:
    """Return what is kept of the file that a take came from; None where it came from none or its frames have changed."""
    origin = take.origin
    if not isinstance(origin, Origin) or not origin.fits(take) or not np.array_equal(origin.weights, take.weights):
        return None
    return Packed(origin.content, origin.rows, origin.lost, origin.swapped)


def unpack(packed: Packed, take: Take) -> Origin:
    """Return the file that a take as it was read came from.

    Raises `ValueError` for parts that cannot be of that take, `FormatError` where the text does not begin as one does.
    """
    rows, lost = packed.rows, packed.lost
    if not (np.diff(rows) > 0).all() or rows[0] != 0 or rows[-1] != len(take) - 1:
        raise ValueError("rows out of order")
    starts = row_starts(packed.content, len(rows))
    if lost.all() or starts[0] > MAX_HEADER_BYTES:
        raise ValueError("no face, or a first line that is too long")
    columns_of(header_of(packed.content[: starts[0]]), take.name, swapped=packed.swapped)
    return Origin(packed.content, starts, rows, lost, take.weights, take.rotations, packed.swapped)
