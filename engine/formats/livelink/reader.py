"""Live Link Face CSV: what the iPhone app records, and what generators imitate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from engine.errors import FormatError
from engine.formats.base.content import content_of
from engine.formats.base.reading import AUTOMATIC, ReadAs, Reading
from engine.formats.base.unfinished import is_unfinished, whole_rows
from engine.formats.livelink.clock import Clock, clock_of
from engine.formats.livelink.columns import EXPECTED, ROTATIONS, Columns, columns_of
from engine.formats.livelink.origin import MAX_HEADER_BYTES, Origin, header_of, lost_frames
from engine.formats.livelink.plain import plain_csv
from engine.formats.livelink.sides import Judgement, exchange, judge
from engine.formats.livelink.table import table
from engine.take import SHAPES, Array, Mask, Take

MAX_COLUMNS = 1024
LARGEST = 1e4  # a weight or an angle beyond this is damage; generators that count in percent stay below


def read(path: Path, report: Callable[[float], None] | None = None, reading: Reading = AUTOMATIC) -> Take:
    """Read a Live Link Face CSV.

    Parameters
    ----------
    path : the file
    report : is told now and then what share of the file is read; what it raises ends the reading
    reading : the rate, and whose left and right its columns are named by, where that is not to be found out

    Raises
    ------
    FormatError : with file, row and column, where the file is not such a take
    """
    return parse(_content(path), path, report, reading)


def parse(
    content: bytes, path: Path, report: Callable[[float], None] | None = None, reading: Reading = AUTOMATIC
) -> Take:
    """Read what a Live Link Face CSV holds, like `read`; `path` is what errors call it."""
    content, resaved = plain_csv(content, path)
    names, begin = _header(content, path)
    named = columns_of(tuple(names), path.name, swapped=False)
    timecodes, values, lost, starts = table(content, begin, (names, named.cells), path, report)
    if lost.all():
        raise FormatError(f"{path.name} holds no frame with a face.", "The tracker lost the face in every row.")
    _require_possible(values, names, path)
    clock = clock_of(timecodes, reading.fps)
    judged = judge(dict(zip(np.array(SHAPES)[named.shapes], values[:, named.shape_cells - 2].T, strict=True)), ~lost)
    swapped = judged.recorded if reading.sides == "automatic" else reading.sides == "recorded"
    take = Take(
        *_resample(values, lost, clock, columns_of(tuple(names), path.name, swapped=swapped)),
        name=path.name,
        notices=(*resaved, *clock.notices, *_said_sides(judged, reading)),
        start_s=clock.start_s,
    )
    return replace(take, origin=Origin(content, starts, clock.rows, lost, take.weights, take.rotations, swapped))


def reread(take: Take, reading: Reading, *, keep: bool = False) -> Take:
    """Return a take as another reading of its file gives it, its edits with it; frames stay frames.

    The rate is the one that is asked for or that the timecodes tell, and left and right of mouth and jaw are exchanged
    where they were read otherwise. With `keep`, what is not asked for stays as it is.
    """
    if keep and reading == AUTOMATIC:
        return take
    if keep and reading.fps is None:
        reading = replace(reading, fps=take.fps)
    if keep and reading.sides == "automatic":
        reading = replace(reading, sides="recorded" if read_as(take).swapped else "named")
    found = resolved(take, reading)
    return put(take, found)


def resolved(take: Take, reading: Reading) -> ReadAs:
    """Return what a reading of the file of a take comes to; where there is none, the rate is the take's own."""
    origin = take.origin
    if not isinstance(origin, Origin):
        return ReadAs(reading, float(reading.fps or take.fps), swapped=True)
    swapped = judged(origin).recorded if reading.sides == "automatic" else reading.sides == "recorded"
    return ReadAs(reading, float(reading.fps or clock_of(origin.timecodes).fps), swapped)


def read_as(take: Take) -> ReadAs:
    """Return what a take was read as."""
    return ReadAs(AUTOMATIC, float(take.fps), take.origin.swapped if isinstance(take.origin, Origin) else True)


def put(take: Take, wanted: ReadAs) -> Take:
    """Return a take with a rate and sides; putting back what it was read as gives it back to the bit."""
    if wanted.fps != take.fps:
        take = replace(take, fps=wanted.fps)
    origin = take.origin
    if not isinstance(origin, Origin) or origin.swapped == wanted.swapped:
        return take
    origin = replace(origin, weights=exchange(origin.weights), swapped=wanted.swapped)
    return replace(take, weights=exchange(take.weights), origin=origin)


def judged(origin: Origin) -> Judgement:
    """Return what the motion of a file tells of its sides."""
    weights = origin.weights[origin.rows]
    named = exchange(weights) if origin.swapped else weights
    return judge(dict(zip(SHAPES, named.T, strict=True)), ~origin.lost)


def _said_sides(judged: Judgement, reading: Reading) -> list[str]:
    """Say what the motion told, where that is not what most files are."""
    if reading.sides != "automatic" or judged.agreement is None:
        return []
    if not judged.recorded:
        return [
            "Left and right of mouth and jaw are taken as named, since the mouth moves with its own side "
            f"({judged.confidence})."
        ]
    if judged.confidence == "uncertain":
        return ["Left and right of mouth and jaw are taken as the app records; the motion does not tell for certain."]
    return []


def _content(path: Path) -> bytes:
    content = whole_rows(content_of(path)) if is_unfinished(path) else content_of(path)
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


def _resample(values: Array, lost: Mask, clock: Clock, columns: Columns) -> tuple[Array, float, Mask, Array]:
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
    for array in (weights, rotations):
        array.flags.writeable = False  # so that the take need not copy them
    return weights, clock.fps, lost_frames(clock.rows, lost, clock.file_fps), rotations
