"""The file that a take was read from, kept with it so that rows nobody changed are written back as they came."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from engine.take import Array, Mask, Take

Places = npt.NDArray[np.int64]
# Absent rows that last longer than this are lost frames; fewer are interpolated, and a single one always is. Recordings
# miss single frames (16 to 42 ms). Lips meet for p, b and m for 60 ms and more, so a longer gap may hide a closure.
GAP_S = 0.05
MAX_HEADER_BYTES = 64 * 1024


@dataclass(frozen=True, eq=False)
class Origin:
    """The text of a file, and what reading made of it.

    Attributes
    ----------
    content : the file as it came
    starts : (rows + 1,) where each row begins in it, and where the last one ends
    rows : (rows,) the take's frame that each row became, rising
    lost : (rows,) bool, rows without a face
    weights, rotations : (frames, 52) and (frames, 9), the take as read
    swapped : whether left and right of mouth and jaw were exchanged on import
    """

    content: bytes
    starts: Places
    rows: Places
    lost: Mask
    weights: Array
    rotations: Array
    swapped: bool = True

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def head(self) -> bytes:
        """The file up to its first row: byte order mark, names of the columns."""
        return self.content[: self.starts[0]]

    @property
    def header(self) -> tuple[str, ...]:
        """The names of the columns, as the file spells them."""
        return header_of(self.head)

    @property
    def timecodes(self) -> list[bytes]:
        """The first cell of each row."""
        bounds = zip(self.starts[:-1].tolist(), self.starts[1:].tolist(), strict=True)
        cells = (self.content[start : self.content.find(b",", start, stop)] for start, stop in bounds)
        return [cell.strip() for cell in cells]

    def fits(self, take: Take) -> bool:
        """Whether a take still has this file's frames."""
        return len(take) == len(self.weights)

    def text(self, first: int, last: int) -> bytes:
        """Return the text of rows, half-open, with their line endings."""
        return self.content[self.starts[first] : self.starts[last]]


def header_of(head: bytes) -> tuple[str, ...]:
    """Return the names in a first line; raises `UnicodeDecodeError` where it is no text."""
    line = head.removeprefix(b"\xef\xbb\xbf").decode("utf-8")
    return tuple(cell.strip() for cell in line.split(","))


def row_starts(content: bytes, rows: int) -> Places:
    """Return where each of so many rows begins below a file's first line, and where the last one ends.

    Raises `ValueError` where there are fewer.
    """
    starts = np.flatnonzero(np.frombuffer(content, np.uint8) == ord("\n"))[: rows + 1] + 1
    if len(starts) == rows and starts[-1] < len(content):
        starts = np.append(starts, len(content))  # the last row has no line ending
    if len(starts) != rows + 1:
        raise ValueError("rows are missing")
    return starts.astype(np.int64)


def lost_frames(rows: Places, lost: Mask, fps: float) -> Mask:
    """Return which frames of a take are lost, (frames,) bool: rows without a face, and long gaps of absent rows.

    Absent rows between two rows without a face are lost as well.

    Parameters
    ----------
    rows : (rows,) the frame that each row of a file is, rising
    lost : (rows,) bool, rows without a face
    fps : frames per second by the file's own clock, whatever the take is played at
    """
    frames = np.zeros(int(rows[-1]) + 1, bool)
    frames[rows[lost]] = True
    absent = np.diff(rows) - 1
    gone = (absent > 0) & (lost[:-1] & lost[1:] | (absent > 1) & (absent > GAP_S * fps))
    for row in np.flatnonzero(gone).tolist():
        frames[rows[row] + 1 : rows[row + 1]] = True
    return frames
