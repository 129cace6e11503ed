"""Live Link Face CSV: what the iPhone app records, and what generators imitate."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from engine.errors import FormatError
from engine.formats.atomic import write_bytes
from engine.formats.content import content_of
from engine.formats.livelink_clock import Clock, clock_of
from engine.formats.livelink_sides import Judgement, exchange, exchange_cells, judge, recorded_name, written_recorded
from engine.formats.livelink_table import table
from engine.formats.livelink_timecode import DAY_S
from engine.formats.reading import AUTOMATIC, ReadAs, Reading, Sides
from engine.take import SHAPE_INDEX, SHAPES, Array, Mask, Take

ROTATIONS = (
    "HeadYaw",
    "HeadPitch",
    "HeadRoll",
    *(f"{s}Eye{a}" for s in ("Left", "Right") for a in ("Yaw", "Pitch", "Roll")),
)
ROTATION_PLACES = {name: index for index, name in enumerate(ROTATIONS)}
DEFAULT_HEADER = ("Timecode", "BlendshapeCount", *(f"{name[0].upper()}{name[1:]}" for name in SHAPES), *ROTATIONS)
TICKS_PER_SECOND = 60.0  # the frame field counts sixtieths of a second, even in a 30 Hz take
MAX_COLUMNS = 1024
MAX_HEADER_BYTES = 64 * 1024
LARGEST = 1e4  # a weight or an angle beyond this is damage; generators that count in percent stay below
EXPECTED = "Retake reads the CSV files that Live Link Face records."


@dataclass(frozen=True, eq=False)
class Origin:
    """How a file was written, so that an untouched take is written back byte for byte.

    Attributes
    ----------
    header : column names as the file spells them
    timecodes : one text per row of the file
    rows : (rows,) int, the take's frame that each row of the file became
    values : (rows, columns) float64 as recorded, lost rows zero
    decimals : digits behind the point
    newline, swapped : line ending; whether left and right of mouth and jaw were exchanged on import
    """

    header: tuple[str, ...]
    timecodes: tuple[bytes, ...]
    rows: npt.NDArray[np.int64]
    values: Array
    lost: Mask
    decimals: int = 10
    newline: bytes = b"\n"
    swapped: bool = True


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
    header, begin = _header(content, path)
    newline = b"\r\n" if b"\r\n" in content[:MAX_HEADER_BYTES] else b"\n"
    columns = _columns(header, path)
    timecodes, values, lost = table(content, begin, header, path, report)
    if lost.all():
        raise FormatError(f"{path.name} holds no frame with a face.", "The tracker lost the face in every row.")
    _require_possible(values, header, path)
    clock = clock_of(timecodes, reading.fps)
    judged = _judged(values, lost, columns)
    swapped = judged.recorded if reading.sides == "automatic" else reading.sides == "recorded"
    take_weights, take_lost, rotations = _resample(values, lost, clock, columns, swap=swapped)
    decimals = _decimals(content, begin)
    origin = Origin(tuple(header), tuple(timecodes), clock.rows, values, lost, decimals, newline, swapped)
    return Take(
        weights=take_weights,
        fps=clock.fps,
        lost=take_lost,
        rotations=rotations,
        name=path.name,
        notices=(*clock.notices, *_said_sides(judged, reading)),
        start_s=clock.start_s,
        origin=origin,
    )


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
    return replace(take, weights=exchange(take.weights), origin=replace(origin, swapped=wanted.swapped))


def judged(origin: Origin) -> Judgement:
    """Return what the motion of a file tells of its sides."""
    return _judged(origin.values, origin.lost, _columns(list(origin.header), Path()))


def _judged(values: Array, lost: Mask, columns: dict[str, int]) -> Judgement:
    return judge({name: values[:, column] for name, column in columns.items()}, ~lost)


def _said_sides(judged: Judgement, reading: Reading) -> list[str]:
    """Say what the motion told, where that is not what most files are."""
    if reading.sides != "automatic" or judged.agreement is None:
        return []
    if not judged.recorded:
        return [
            "Left and right of mouth and jaw are taken as named, since the mouth moves with its own side "
            f"({judged.confidence}, r = {judged.agreement:+.2f})."
        ]
    if judged.confidence == "uncertain":
        return ["Left and right of mouth and jaw are taken as the app records; the motion does not tell for certain."]
    return []


def write(take: Take, path: Path, sides: Sides = "automatic") -> None:
    """Write a take as Live Link Face CSV, in the convention of the file it came from where there was one.

    Frames that the source file had missed stay missing and values that were not edited are written as they were read,
    so that reading and writing a take changes no byte. With `sides` recorded or named, left and right of mouth and jaw
    are written as the app does or by their names, whatever the file had.
    """
    origin = _origin_of(take)
    lines: Iterator[bytes] = _encode(take)
    if written_recorded(sides, swapped=origin.swapped) != origin.swapped:
        lines = exchange_cells(lines, origin.header)
    write_bytes(path, lines)


def _origin_of(take: Take) -> Origin:
    return take.origin if isinstance(take.origin, Origin) and _fits(take, take.origin) else _new_origin(take)


def _encode(take: Take) -> Iterator[bytes]:
    origin = _origin_of(take)
    columns = _columns(list(origin.header), Path(take.name))
    values = origin.values.copy()
    source = take.weights[origin.rows]
    before, _, _ = _resample(origin.values, origin.lost, Clock(take.fps, origin.rows), columns, swap=origin.swapped)
    changed = source != before[origin.rows]
    for shape, column in columns.items():
        if shape in SHAPE_INDEX:
            index = SHAPE_INDEX[recorded_name(shape, swapped=origin.swapped)]
            values[:, column] = np.where(changed[:, index], source[:, index], values[:, column])
    lost = origin.lost & take.lost[origin.rows]
    yield ",".join(origin.header).encode() + origin.newline
    yield from _rows(origin.timecodes, values, lost, origin.decimals, origin.newline)


def _rows(
    timecodes: Iterable[bytes], values: Array, lost: Mask, decimals: int = 10, newline: bytes = b"\n"
) -> Iterator[bytes]:
    count = values.shape[1]
    row_format = ",".join([f"%.{decimals}f"] * count)
    for timecode, row, is_lost in zip(timecodes, values.tolist(), lost, strict=True):
        body = b"0" if is_lost else f"{count},{row_format % tuple(row)}".encode()
        yield timecode + b"," + body + newline


def header() -> bytes:
    """Return the first line of a file that grows row by row."""
    return ",".join(DEFAULT_HEADER).encode() + b"\n"


def rows(times_s: Array, weights: Array, rotations: Array, lost: Mask) -> Iterator[bytes]:
    """Yield the lines of frames at times of their own: weights (frames, 52), rotations (frames, 9), lost (frames,)."""
    timecodes = (_format_timecode(float(tick)) for tick in np.round(times_s * TICKS_PER_SECOND, 3))
    return _rows(timecodes, _recorded_columns(weights, rotations), lost)


def _recorded_columns(weights: Array, rotations: Array) -> Array:
    """Return (frames, 61) columns as `DEFAULT_HEADER` names them."""
    order = [SHAPE_INDEX[recorded_name(name, swapped=True)] for name in SHAPES]
    return np.concatenate([weights[:, order], rotations], axis=1)


def _fits(take: Take, origin: Origin) -> bool:
    return len(origin.rows) > 0 and int(origin.rows[-1]) == len(take) - 1


def _new_origin(take: Take) -> Origin:
    frames = np.arange(len(take))
    ticks = np.round((take.start_s + frames / take.fps) * TICKS_PER_SECOND, 3)
    timecodes = tuple(_format_timecode(float(tick)) for tick in ticks)
    values = _recorded_columns(take.weights, take.rotations)
    return Origin(DEFAULT_HEADER, timecodes, frames, values, take.lost)


def _format_timecode(ticks: float) -> bytes:
    whole, part = divmod(ticks % (DAY_S * TICKS_PER_SECOND), TICKS_PER_SECOND)
    second = int(whole)
    return f"{second // 3600:02d}:{second // 60 % 60:02d}:{second % 60:02d}:{part:06.3f}".encode()


def _content(path: Path) -> bytes:
    content = content_of(path)
    if not content or content.isspace():
        raise FormatError(f"{path.name} is empty.", EXPECTED)
    return content.removeprefix(b"\xef\xbb\xbf")


def _header(content: bytes, path: Path) -> tuple[list[str], int]:
    """Return the names of the columns, and where the row after them begins."""
    end = content.find(b"\n") % (len(content) + 1)
    if end > MAX_HEADER_BYTES or content.count(b",", 0, end) >= MAX_COLUMNS:
        raise FormatError(f"{path.name} has too many columns in its first row.", EXPECTED)
    try:
        header = [cell.strip() for cell in content[:end].decode("utf-8").split(",")]
    except UnicodeDecodeError:
        raise FormatError(f"{path.name} is not a text file.", EXPECTED) from None
    if "\x00" in header[0]:
        raise FormatError(f"{path.name} is not a text file.", EXPECTED)
    return header, end + 1


def _columns(header: list[str], path: Path) -> dict[str, int]:
    """Map our shape and rotation names to value columns (counted from the third cell); names, never positions."""
    if [cell.lower() for cell in header[:2]] != ["timecode", "blendshapecount"]:
        raise FormatError(f"{path.name} does not begin with the header of a Live Link Face take.", EXPECTED)
    found = {cell.lower(): index for index, cell in enumerate(header[2:])}
    if len(found) != len(header) - 2:
        raise FormatError(f"{path.name} names a column twice in its first row.")
    columns = {name: found[name.lower()] for name in (*SHAPES, *ROTATIONS) if name.lower() in found}
    missing = [name for name in SHAPES if name not in columns and name != "tongueOut"]
    if missing:
        raise FormatError(f"{path.name} lacks the column {missing[0]} ({len(missing)} shapes are missing).", EXPECTED)
    return columns


def _require_possible(values: Array, header: list[str], path: Path) -> None:
    bad = np.argwhere(~np.isfinite(values))
    if len(bad):
        row, column = bad[0]
        raise FormatError(
            f"{path.name} has a value that is not a finite number in row {row + 2}, column {column + 3} "
            f"({header[column + 2][:40]})."
        )
    huge = np.argwhere(np.abs(values) > LARGEST)
    if len(huge):
        row, column = huge[0]
        raise FormatError(
            f"{path.name} has {values[row, column]:g} in row {row + 2}, column {column + 3} "
            f"({header[column + 2][:40]}), which no face can do.",
            "Weights lie in 0..1.",
        )


def _resample(
    values: Array, lost: Mask, clock: Clock, columns: dict[str, int], *, swap: bool
) -> tuple[Array, Mask, Array]:
    """Put rows on the constant clock; missed and lost frames are interpolated, and lost ones marked."""
    frames = int(clock.rows[-1]) + 1
    weights = np.zeros((frames, len(SHAPES)))
    rotations = np.zeros((frames, len(ROTATIONS)))
    grid, seen = np.arange(frames), clock.rows[~lost]
    whole = frames == len(values) and not lost.any()
    for kept, places in ((weights, SHAPE_INDEX), (rotations, ROTATION_PLACES)):
        found = {places[recorded_name(name, swapped=swap)]: at for name, at in columns.items() if name in places}
        recorded = values[:, list(found.values())]  # all of a row at once, as it lies in memory
        if whole:
            kept[:, list(found)] = recorded
        else:
            for index, curve in zip(found, recorded[~lost].T, strict=True):
                kept[:, index] = np.interp(grid, seen, curve)
    take_lost = np.zeros(frames, bool)
    take_lost[clock.rows[lost]] = True
    gaps = np.interp(grid, clock.rows, lost.astype(float)) if not whole else np.zeros(frames)
    return weights, take_lost | (gaps == 1.0), rotations


def _decimals(content: bytes, first: int) -> int:
    """Return how many digits the first row with a face has behind the point."""
    cells: list[bytes] = []
    while len(cells) < 3:
        end = content.find(b"\n", first) % (len(content) + 1)
        cells, first = content[first:end].split(b","), end + 1
    digits = [len(cell.strip().partition(b".")[2]) for cell in cells[2:]]
    return min(max(digits, default=10), 17) or 10
