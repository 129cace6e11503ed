"""Live Link Face CSV: what the iPhone app records, and what generators imitate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from engine.errors import FormatError
from engine.formats.content import content_of
from engine.formats.decimals import floats
from engine.formats.livelink_header import DEFAULT_HEADER, EXPECTED, ROTATIONS, Columns, columns_of
from engine.formats.livelink_origin import Origin, header_of, lost_frames
from engine.formats.livelink_table import table
from engine.formats.livelink_write import DAY_S, TICKS_PER_SECOND, header, rows, write
from engine.take import SHAPES, Array, Mask, Take

__all__ = ["DEFAULT_HEADER", "header", "read", "rows", "write"]
STANDARD_FPS = (24.0, 25.0, 30000 / 1001, 30.0, 48.0, 50.0, 60000 / 1001, 60.0, 120.0)
MAX_COLUMNS = 1024
MAX_HEADER_BYTES = 64 * 1024
LARGEST = 1e4  # a weight or an angle beyond this is damage; generators that count in percent stay below
MAX_INSERTED_SHARE = 1.0  # more missed frames than recorded ones means that the clock is not to be believed
FALLBACK_FPS = 30.0
BLOCK_ROWS = 4096  # of timecodes read at once
COLON = ord(":")


@dataclass
class _Clock:
    """Frame rate and frame number of each row, with what the user should hear about it."""

    fps: float
    rows: npt.NDArray[np.int64]
    notices: list[str] = field(default_factory=list)


def read(
    path: Path, report: Callable[[float], None] | None = None, *, fps: float | None = None, swap: bool = True
) -> Take:
    """Read a Live Link Face CSV.

    Parameters
    ----------
    path : the file
    report : is told now and then what share of the file is read; what it raises ends the reading
    fps : frame rate to use instead of the one its timecodes tell
    swap : exchange left and right of mouth and jaw, which the app records under each other's names

    Raises
    ------
    FormatError : with file, row and column, where the file is not such a take
    """
    content = _content(path)
    names, begin = _header(content, path)
    columns = columns_of(tuple(names), path.name, swapped=swap)
    timecodes, values, lost, starts = table(content, begin, names, path, report)
    if lost.all():
        raise FormatError(f"{path.name} holds no frame with a face.", "The tracker lost the face in every row.")
    _require_possible(values, names, path)
    clock = _clock(timecodes, fps)
    take = Take(
        *_resample(values, lost, clock, columns),
        name=path.name,
        notices=tuple(clock.notices),
        start_s=0.0 if (first := _seconds(timecodes[:1])) is None else float(first[0]),
    )
    origin = Origin(content, starts, clock.rows, lost, take.weights, take.rotations, take.fps, swap)
    take, suspicion = replace(take, origin=origin), _side_suspicion(take)
    return take if suspicion is None else replace(take, notices=(*take.notices, suspicion))


def _content(path: Path) -> bytes:
    content = content_of(path)
    if not content or content.isspace():
        raise FormatError(f"{path.name} is empty.", EXPECTED)
    return content


def _header(content: bytes, path: Path) -> tuple[list[str], int]:
    """Return the names of the columns, and where the row after them begins."""
    end = content.find(b"\n") % (len(content) + 1)
    if end > MAX_HEADER_BYTES or content.count(b",", 0, end) >= MAX_COLUMNS:
        raise FormatError(f"{path.name} has too many columns in its first row.", EXPECTED)
    try:
        names = list(header_of(content[:end]))
    except UnicodeDecodeError:
        raise FormatError(f"{path.name} is not a text file.", EXPECTED) from None
    if "\x00" in names[0]:
        raise FormatError(f"{path.name} is not a text file.", EXPECTED)
    return names, end + 1


def _require_possible(values: Array, names: list[str], path: Path) -> None:
    bad = np.argwhere(~np.isfinite(values))
    if len(bad):
        row, column = bad[0]
        raise FormatError(
            f"{path.name} has a value that is not a finite number in row {row + 2}, column {column + 3} "
            f"({names[column + 2][:40]})."
        )
    huge = np.argwhere(np.abs(values) > LARGEST)
    if len(huge):
        row, column = huge[0]
        raise FormatError(
            f"{path.name} has {values[row, column]:g} in row {row + 2}, column {column + 3} "
            f"({names[column + 2][:40]}), which no face can do.",
            "Weights lie in 0..1.",
        )


def _seconds(timecodes: list[bytes]) -> Array | None:
    """Return times, (rows,) in seconds, of `HH:MM:SS:FF.mmm`; None where one of them is no time."""
    if any(timecode.count(b":") != 3 for timecode in timecodes):
        return None
    try:
        parts = np.concatenate(
            [_parts(timecodes[first : first + BLOCK_ROWS]) for first in range(0, len(timecodes), BLOCK_ROWS)]
        )
    except ValueError:
        return None
    times = parts @ np.array([3600.0, 60.0, 1.0, 1.0 / TICKS_PER_SECOND])
    return times if len(times) == len(timecodes) and np.isfinite(times).all() else None


def _parts(timecodes: list[bytes]) -> Array:
    """Return the four numbers of each timecode, (rows, 4); `ValueError` where one is none."""
    text = np.frombuffer(b":".join(timecodes) + b":", np.uint8)
    ends = np.flatnonzero(text == COLON)
    return floats(text, np.concatenate([[0], ends[:-1] + 1]), ends).reshape(-1, 4)


def _clock(timecodes: list[bytes], fps: float | None) -> _Clock:
    rows = np.arange(len(timecodes))
    if fps is not None:
        return _Clock(fps, rows)
    if len(timecodes) == 1:
        return _Clock(FALLBACK_FPS, rows, [f"One frame has no rate: taken as {FALLBACK_FPS:g} fps."])
    times = _seconds(timecodes)
    fallback = _Clock(FALLBACK_FPS, rows, [f"The timecodes make no sense: taken as {FALLBACK_FPS:g} fps, row by row."])
    if times is None:
        return fallback
    steps = np.diff(times)
    steps = np.where(steps < -DAY_S / 2, steps + DAY_S, steps)  # past midnight
    typical = float(np.median(steps))
    if typical <= 1 / 1000 or typical > 0.5 or (steps <= 0).any():
        return fallback
    single = steps[np.abs(steps / typical - 1) < 0.5]
    rate = 1 / float(single.mean())
    increments = np.maximum(1, np.round(steps * rate)).astype(np.int64)
    inserted = int(increments.sum() - len(increments))
    if inserted > MAX_INSERTED_SHARE * len(timecodes):
        return fallback
    frame = np.concatenate([[0], np.cumsum(increments)])
    notices = [f"{inserted} missed frames were filled in by interpolation."] if inserted else []
    return _Clock(_snap(rate), frame, notices)


def _snap(rate: float) -> float:
    nearest = min(STANDARD_FPS, key=lambda standard: abs(standard - rate))
    return nearest if abs(nearest / rate - 1) < 5e-4 else rate


def _resample(values: Array, lost: Mask, clock: _Clock, columns: Columns) -> tuple[Array, float, Mask, Array]:
    """Return weights, rate, lost frames and rotations on the constant clock; what no row tells is interpolated."""
    frames = int(clock.rows[-1]) + 1
    weights, rotations = np.zeros((frames, len(SHAPES))), np.zeros((frames, len(ROTATIONS)))
    grid, seen = np.arange(frames), clock.rows[~lost]
    whole = frames == len(values) and not lost.any()
    for kept, places, cells in (
        (weights, columns.shapes, columns.shape_cells),
        (rotations, columns.rotations, columns.rotation_cells),
    ):
        recorded = values[:, cells - 2]  # all of a row at once, as it lies in memory
        if whole:
            kept[:, places] = recorded
        else:
            for index, curve in zip(places, recorded[~lost].T, strict=True):
                kept[:, index] = np.interp(grid, seen, curve)
    return weights, clock.fps, lost_frames(clock.rows, lost, clock.fps), rotations


def _side_suspicion(take: Take) -> str | None:
    """Say so when the mouth still leans against its own side: the swap was wrong for this file, or missing."""
    side = take.curve("mouthLeft") - take.curve("mouthRight")
    if side.std() < 0.02:
        return None
    correlations = []
    for pair in ("mouthDimple", "mouthStretch", "cheekSquint"):
        other = take.curve(f"{pair}Left") - take.curve(f"{pair}Right")
        if other.std() > 0.005:
            correlations.append(float(np.corrcoef(side, other)[0, 1]))
    if len(correlations) >= 2 and max(correlations) < -0.3:
        return "Left and right of the mouth look exchanged: try the import without the swap."
    return None
