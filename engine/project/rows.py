"""Records to rows and back; whatever a file says is checked before it is believed."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Callable, Iterable, Sequence
from datetime import UTC, datetime
from typing import Any

import numpy as np

from engine.controls import ALL_CONTROLS, ALL_INDEX
from engine.errors import EngineError
from engine.formats.livelink import DAY_S, MAX_COLUMNS, Origin
from engine.project.blobs import Budget, DamagedError, pack, unpack, unpack_bytes
from engine.project.records import MARK, Contents, Edit, Marks, Media, Note, Pin, Span, Summary, marks_of
from engine.project.replaying import said
from engine.take import SHAPE_INDEX, SHAPES, Array, Take

MAX_FRAMES = 1_000_000  # over four hours at 60 fps
MAX_FPS = 10_000.0
MAX_WEIGHT = 1e6
MAX_DECIMALS = 17
JSON_BYTES = 32  # that a character of JSON may grow to when it is read
ROTATIONS = 9


def write_contents(database: sqlite3.Connection, contents: Contents, report: Callable[[float], None]) -> None:
    """Fill empty tables; `report` hears the share of the frames that are written."""
    takes = [contents.original.weights, *(edit.weights for edit in contents.edits)]
    written = np.cumsum([len(weights) for weights in takes])
    report(0.0)
    _write_take(database, contents.original)
    for place, edit in enumerate(contents.edits):
        report(written[place] / written[-1])
        write_edits(database, place, (edit,))
    write_marks(database, contents.marks)
    write_state(database, contents)


def read_contents(database: sqlite3.Connection, budget: Budget) -> Contents:
    """Return what a checked file holds; raises `DamagedError` with what is wrong."""
    try:
        take = _read_take(database, budget)
        edits = tuple(_read_edits(database, len(take), budget))
        _require_said(edits)
        position, verdict = one(database, "SELECT position, verdict FROM state")
        _require(0 <= position <= len(edits), "its place in the undo history is not there")
        return Contents(take, edits, position, _read_marks(database, verdict, len(take), budget))
    except EngineError as error:
        raise DamagedError(error.sentence.rstrip(".")) from error


def read_summary(database: sqlite3.Connection) -> Summary:
    """Return what a checked file is; raises `DamagedError`."""
    name, frames, fps = one(database, "SELECT name, frames, fps FROM take")
    position, changed = one(database, "SELECT position, changed FROM state")
    _require(1 <= frames <= MAX_FRAMES and 0 < fps <= MAX_FPS, "its length or frame rate is not possible")
    try:
        when = datetime.fromisoformat(changed)
    except ValueError as error:
        raise DamagedError("the time of its last change is none") from error
    return Summary(name, frames, fps, position, when if when.tzinfo else when.replace(tzinfo=UTC))


def write_edits(database: sqlite3.Connection, first: int, edits: Iterable[Edit]) -> None:
    """Let these edits follow the first so many, in place of what came after."""
    database.execute("DELETE FROM edits WHERE place >= ?", (first,))
    names = json.dumps([control.name for control in ALL_CONTROLS])
    for place, edit in enumerate(edits, first):
        inputs = json.dumps(dict(edit.inputs), default=_plain)
        blobs = pack(edit.weights), names, pack(edit.asked)
        _insert(database, "edits", (place, edit.kind, edit.title, inputs, edit.start, len(edit.weights), *blobs))


def write_marks(database: sqlite3.Connection, marks: Marks) -> None:
    """Put spans, pins, notes and media in place of those that are there."""
    tables: dict[str, list[tuple[object, ...]]] = {
        "spans": [(span.start, span.stop, span.region, span.kind) for span in marks.spans],
        "pins": [(pin.frame, json.dumps(dict(pin.weights)), pin.start, pin.stop) for pin in marks.pins],
        "notes": [(note.frame, note.author, note.time, note.text) for note in marks.notes],
        "media": [(media.kind, media.path, media.sha256, media.offset_s) for media in marks.media],
    }
    for table, rows in tables.items():
        database.execute(f"DELETE FROM {table}")
        database.executemany(
            f"INSERT INTO {table} VALUES (?, ?, ?, ?, ?)", [(place, *row) for place, row in enumerate(rows)]
        )


def write_state(database: sqlite3.Connection, contents: Contents) -> None:
    """Write the place in the undo history, the verdict, and that it is so from now on."""
    row = contents.position, contents.marks.verdict, datetime.now(UTC).isoformat(timespec="seconds")
    database.execute("INSERT OR REPLACE INTO state VALUES (1, ?, ?, ?)", row)


def _write_take(database: sqlite3.Connection, take: Take) -> None:
    blobs = pack(take.weights), pack(take.lost), pack(take.rotations)
    _insert(database, "take", (1, take.name, take.fps, take.start_s, len(take), *blobs))
    origin = take.origin
    if isinstance(origin, Origin):
        timecodes = b"\n".join(origin.timecodes)
        lines = len(origin.timecodes), len(timecodes), pack(np.frombuffer(timecodes, "u1"))
        arrays = pack(origin.rows), pack(origin.values), pack(origin.lost)
        how = origin.decimals, origin.newline, int(origin.swapped)
        _insert(database, "origin", (1, json.dumps(origin.header), *lines, *arrays, *how))


def _insert(database: sqlite3.Connection, table: str, row: Sequence[object]) -> None:
    """Add a row with its number first; room is made for what comes in pieces, which is then filled piece by piece."""
    marks = ["zeroblob(?)" if isinstance(value, list) else "?" for value in row]
    values = [sum(map(len, value)) if isinstance(value, list) else value for value in row]
    database.execute(f"INSERT INTO {table} VALUES ({', '.join(marks)})", values)
    columns = [column for column, *_ in database.execute(f"SELECT * FROM {table} LIMIT 0").description]
    for column, value in zip(columns, row, strict=True):
        if isinstance(value, list):
            with database.blobopen(table, column, row[0]) as blob:  # type: ignore[arg-type]
                for piece in value:
                    blob.write(piece)


def _read_take(database: sqlite3.Connection, budget: Budget) -> Take:
    name, fps, start_s, frames, *blobs = one(
        database, "SELECT name, fps, start_s, frames, weights, lost, rotations FROM take"
    )
    _require(1 <= frames <= MAX_FRAMES and 0 < fps <= MAX_FPS, "its length or frame rate is not possible")
    _require(0 <= start_s <= 2 * DAY_S, "its time of day is not possible")
    weights = unpack(blobs[0], (frames, len(SHAPES)), "<f8", budget)
    rotations = unpack(blobs[2], (frames, ROTATIONS), "<f8", budget)
    _require(_possible(weights) and _possible(rotations), "a weight or rotation is not a finite number")
    lost = unpack(blobs[1], (frames,), "u1", budget) != 0
    origin = _read_origin(database, frames, budget)
    return Take(weights=weights, fps=fps, lost=lost, rotations=rotations, name=name, start_s=start_s, origin=origin)


def _possible(values: Array) -> bool:
    return bool((np.abs(values) <= MAX_WEIGHT).all())


def _read_origin(database: sqlite3.Connection, frames: int, budget: Budget) -> Origin | None:
    row = database.execute(
        "SELECT header, rows, timecode_bytes, timecodes, frames, recorded, lost, decimals, newline, swapped FROM origin"
    ).fetchone()
    if row is None:
        return None
    header, count, timecode_bytes, *blobs, decimals, newline, swapped = row
    names = _texts(header, budget)
    _require(2 < len(names) <= MAX_COLUMNS and 1 <= count <= frames, "the file it came from is not possible")
    _require(not any("," in name or "\n" in name for name in names), "the file it came from is not possible")
    _require(timecode_bytes >= 0, "a timecode is missing")
    timecodes = tuple(unpack_bytes(blobs[0], timecode_bytes, budget).split(b"\n"))
    rows = unpack(blobs[1], (count,), "<i8", budget)
    values = unpack(blobs[2], (count, len(names) - 2), "<f8", budget)
    lost = unpack(blobs[3], (count,), "u1", budget) != 0
    _require(len(timecodes) == count and not any(b"," in code for code in timecodes), "a timecode is missing")
    _require(bool((np.diff(rows) > 0).all()) and rows[0] >= 0 and rows[-1] < frames, "its rows are out of order")
    _require(_possible(values) and not lost.all(), "a recorded value is not a finite number")
    _require(0 <= decimals <= MAX_DECIMALS and newline in (b"\n", b"\r\n"), "the file it came from is not possible")
    return Origin(names, timecodes, rows.astype(np.int64), values, lost, decimals, newline, bool(swapped))


def _read_edits(database: sqlite3.Connection, length: int, budget: Budget) -> Iterable[Edit]:
    found = database.execute(
        "SELECT place, kind, title, inputs, start, frames, weights, controls, asked FROM edits ORDER BY place"
    )
    for index, (place, kind, title, inputs, start, frames, weights, controls, asked) in enumerate(found):
        _require(place == index and start >= 0 and 0 <= frames <= length - start, "an edit is out of place")
        rows = unpack(weights, (frames, len(SHAPES)), "<f8", budget)
        _require(_possible(rows), "an edit holds a weight that is not a finite number")
        made_from = _json(inputs, budget)
        _require(isinstance(made_from, dict), "an edit does not say what it was made from")
        if kind == MARK:
            for marks in ("before", "after"):
                _require_sound(_marks_in(made_from, marks), length)
        yield Edit(kind, title, start, rows, _read_asked(asked, _texts(controls, budget), frames, budget), made_from)


def _read_asked(blob: object, names: tuple[str, ...], frames: int, budget: Budget) -> Array:
    """Return asked values in today's columns: a control that is new since has NaN, one that is gone is left out."""
    stored = unpack(blob, (frames, len(names)), "<f8", budget)
    _require(not np.isinf(stored).any(), "an edit asks for a value that is not finite")
    if names == tuple(ALL_INDEX):
        return np.asarray(stored, np.float64)
    asked = np.full((frames, len(ALL_CONTROLS)), np.nan)
    for column, name in enumerate(names):
        if name in ALL_INDEX:
            asked[:, ALL_INDEX[name]] = stored[:, column]
    return asked


def _read_marks(database: sqlite3.Connection, verdict: str, length: int, budget: Budget) -> Marks:
    def rows(columns: str, table: str) -> list[Any]:
        return database.execute(f"SELECT {columns} FROM {table} ORDER BY place").fetchall()

    marks = Marks(
        spans=tuple(Span(*row) for row in rows("start, stop, region, kind", "spans")),
        pins=tuple(
            Pin(frame, _json(weights, budget), start, stop)
            for frame, weights, start, stop in rows("frame, weights, start, stop", "pins")
        ),
        notes=tuple(Note(*row) for row in rows("frame, author, time, text", "notes")),
        media=tuple(Media(*row) for row in rows("kind, path, sha256, offset_s", "media")),
        verdict=verdict,
    )
    _require_sound(marks, length)
    return marks


def _require_sound(marks: Marks, length: int) -> None:
    try:
        spans = all(0 <= span.start < span.stop <= length for span in marks.spans)
        pins = all(0 <= pin.start <= pin.frame < pin.stop <= length and _is_pose(pin.weights) for pin in marks.pins)
        notes = all(0 <= note.frame < length for note in marks.notes)
        media = all(bool(np.isfinite(entry.offset_s)) for entry in marks.media)
    except TypeError as error:
        raise DamagedError("a mark is not what it should be") from error
    _require(spans, "a span is not within the take")
    _require(pins, "a pin is not within the take, or holds no pose")
    _require(notes, "a note is not within the take")
    _require(media, "an offset is not a finite number")
    frames = [frame for span in marks.spans for frame in (span.start, span.stop)]
    frames += [frame for pin in marks.pins for frame in (pin.frame, pin.start, pin.stop)]
    frames += [note.frame for note in marks.notes]
    _require(all(isinstance(frame, int) for frame in frames), "a mark is not what it should be")
    texts = [text for span in marks.spans for text in (span.region, span.kind)]
    texts += [text for note in marks.notes for text in (note.author, note.time, note.text)]
    texts += [text for entry in marks.media for text in (entry.kind, entry.path, entry.sha256)]
    _require(all(isinstance(text, str) for text in (*texts, marks.verdict)), "a mark is not what it should be")


def _require_said(edits: tuple[Edit, ...]) -> None:
    """Check that each step on the visemes fits the lane that it finds."""
    try:
        said(edits)
    except (KeyError, TypeError, ValueError) as error:
        raise DamagedError("an edit does not say what it did to the visemes") from error


def _is_pose(pose: object) -> bool:
    if not isinstance(pose, dict) or not set(pose) <= set(SHAPE_INDEX):
        return False
    return all(isinstance(value, float | int) and abs(value) < MAX_WEIGHT for value in pose.values())


def _marks_in(inputs: dict[str, Any], name: str) -> Marks:
    try:
        return marks_of(inputs[name])
    except (KeyError, TypeError) as error:
        raise DamagedError("an edit does not say what it marked") from error


def _texts(text: str, budget: Budget) -> tuple[str, ...]:
    names = _json(text, budget)
    _require(isinstance(names, list) and all(isinstance(name, str) for name in names), "a list of names is damaged")
    _require(len(names) <= MAX_COLUMNS, "a list of names is too long")
    return tuple(names)


def _json(text: str, budget: Budget) -> Any:
    budget.take(JSON_BYTES * len(text))
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise DamagedError("a setting cannot be read") from error


def one(database: sqlite3.Connection, query: str) -> Any:
    """Return the one row of a query; raises `DamagedError` when there is none."""
    row = database.execute(query).fetchone()
    _require(row is not None, "a part of it is missing")
    return row


def _require(sound: bool, what: str) -> None:
    if not sound:
        raise DamagedError(what)


def _plain(value: object) -> object:
    """Return a numpy number or array as JSON can hold it."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} cannot be kept with an edit")
