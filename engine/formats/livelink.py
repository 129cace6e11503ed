"""Live Link Face CSV: what the iPhone app records, and what generators imitate."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from engine.errors import FormatError
from engine.formats.atomic import write_bytes
from engine.formats.content import content_of
from engine.formats.decimals import floats
from engine.formats.livelink_table import table
from engine.formats.unfinished import is_unfinished, whole_rows
from engine.take import SHAPE_INDEX, SHAPES, Array, Mask, Take

ROTATIONS = (
    "HeadYaw",
    "HeadPitch",
    "HeadRoll",
    *(f"{s}Eye{a}" for s in ("Left", "Right") for a in ("Yaw", "Pitch", "Roll")),
)
ROTATION_PLACES = {name: index for index, name in enumerate(ROTATIONS)}
DEFAULT_HEADER = ("Timecode", "BlendshapeCount", *(f"{name[0].upper()}{name[1:]}" for name in SHAPES), *ROTATIONS)
# Recorded under each other's names by the app (measured: same-side asymmetries correlate negatively without the swap).
SWAPPED = (("mouthLeft", "mouthRight"), ("jawLeft", "jawRight"))
STANDARD_FPS = (24.0, 25.0, 30000 / 1001, 30.0, 48.0, 50.0, 60000 / 1001, 60.0, 120.0)
TICKS_PER_SECOND = 60.0  # the frame field counts sixtieths of a second, even in a 30 Hz take
DAY_S = 86400.0
MAX_COLUMNS = 1024
MAX_HEADER_BYTES = 64 * 1024
LARGEST = 1e4  # a weight or an angle beyond this is damage; generators that count in percent stay below
MAX_INSERTED_SHARE = 1.0  # more missed frames than recorded ones means that the clock is not to be believed
FALLBACK_FPS = 30.0
BLOCK_ROWS = 4096  # of timecodes read at once
COLON = ord(":")
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
    header, begin = _header(content, path)
    newline = b"\r\n" if b"\r\n" in content[:MAX_HEADER_BYTES] else b"\n"
    columns = _columns(header, path)
    timecodes, values, lost = table(content, begin, header, path, report)
    if lost.all():
        raise FormatError(f"{path.name} holds no frame with a face.", "The tracker lost the face in every row.")
    _require_possible(values, header, path)
    clock = _clock(timecodes, fps)
    take_weights, take_lost, rotations = _resample(values, lost, clock, columns, swap=swap)
    decimals = _decimals(content, begin)
    origin = Origin(tuple(header), tuple(timecodes), clock.rows, values, lost, decimals, newline, swap)
    take = Take(
        weights=take_weights,
        fps=clock.fps,
        lost=take_lost,
        rotations=rotations,
        name=path.name,
        notices=tuple(clock.notices),
        start_s=0.0 if (first := _seconds(timecodes[:1])) is None else float(first[0]),
        origin=origin,
    )
    suspicion = _side_suspicion(take)
    return take if suspicion is None else replace(take, notices=(*take.notices, suspicion))


def write(take: Take, path: Path) -> None:
    """Write a take as Live Link Face CSV, in the convention of the file it came from where there was one.

    Frames that the source file had missed stay missing and values that were not edited are written as they were read,
    so that reading and writing a take changes no byte.
    """
    write_bytes(path, _encode(take))


def _encode(take: Take) -> Iterator[bytes]:
    origin = take.origin if isinstance(take.origin, Origin) and _fits(take, take.origin) else _new_origin(take)
    columns = _columns(list(origin.header), Path(take.name))
    values = origin.values.copy()
    source = take.weights[origin.rows]
    before, _, _ = _resample(origin.values, origin.lost, _Clock(take.fps, origin.rows), columns, swap=origin.swapped)
    changed = source != before[origin.rows]
    for shape, column in columns.items():
        if shape in SHAPE_INDEX:
            index = SHAPE_INDEX[_recorded_name(shape, swapped=origin.swapped)]
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
    order = [SHAPE_INDEX[_recorded_name(name, swapped=True)] for name in SHAPES]
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


def _recorded_name(shape: str, *, swapped: bool) -> str:
    """Return the shape whose values stand in the file under the name `shape`."""
    if swapped:
        for left, right in SWAPPED:
            if shape in (left, right):
                return right if shape == left else left
    return shape


def _content(path: Path) -> bytes:
    content = whole_rows(content_of(path)) if is_unfinished(path) else content_of(path)
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


def _resample(
    values: Array, lost: Mask, clock: _Clock, columns: dict[str, int], *, swap: bool
) -> tuple[Array, Mask, Array]:
    """Put rows on the constant clock; missed and lost frames are interpolated, and lost ones marked."""
    frames = int(clock.rows[-1]) + 1
    weights = np.zeros((frames, len(SHAPES)))
    rotations = np.zeros((frames, len(ROTATIONS)))
    grid, seen = np.arange(frames), clock.rows[~lost]
    whole = frames == len(values) and not lost.any()
    for kept, places in ((weights, SHAPE_INDEX), (rotations, ROTATION_PLACES)):
        found = {places[_recorded_name(name, swapped=swap)]: at for name, at in columns.items() if name in places}
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
