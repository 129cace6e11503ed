"""Records to rows and back; whatever a file says is checked before it is believed."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable
from typing import Any

import numpy as np

from engine.controls import CONTROL_INDEX, CONTROLS
from engine.errors import EngineError
from engine.formats.livelink import DAY_S, MAX_COLUMNS, Origin
from engine.project.blobs import Budget, DamagedError, pack, unpack, unpack_bytes
from engine.project.records import Contents, Edit, Marks, Media, Note, Pin, Span
from engine.take import SHAPE_INDEX, SHAPES, Array, Take

MAX_FRAMES = 1_000_000  # over four hours at 60 fps
MAX_FPS = 10_000.0
MAX_DECIMALS = 17
JSON_BYTES = 32  # that a character of JSON may grow to when it is read
ROTATIONS = 9


def write_contents(database: sqlite3.Connection, contents: Contents) -> None:
    """Fill empty tables."""
    _write_take(database, contents.original)
    write_edits(database, 0, contents.edits)
    write_marks(database, contents.marks)
    write_state(database, contents)


def read_contents(database: sqlite3.Connection, budget: Budget) -> Contents:
    """Return what a checked file holds; raises `DamagedError` with what is wrong."""
    try:
        take = _read_take(database, budget)
        edits = tuple(_read_edits(database, len(take), budget))
        position, verdict = one(database, "SELECT position, verdict FROM state")
        _require(0 <= position <= len(edits), "its place in the undo history is not there")
        return Contents(take, edits, position, _read_marks(database, verdict, len(take), budget))
    except EngineError as error:
        raise DamagedError(error.sentence.rstrip(".")) from error


def write_edits(database: sqlite3.Connection, first: int, edits: Iterable[Edit]) -> None:
    """Let these edits follow the first so many, in place of what came after."""
    database.execute("DELETE FROM edits WHERE place >= ?", (first,))
    names = json.dumps([control.name for control in CONTROLS])
    for place, edit in enumerate(edits, first):
        inputs = json.dumps(dict(edit.inputs), default=_plain)
        blobs = pack(edit.weights), names, pack(edit.asked)
        row = (place, edit.kind, edit.title, inputs, edit.start, len(edit.weights), *blobs)
        database.execute("INSERT INTO edits VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)", row)


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
    """Write the place in the undo history, and the verdict."""
    database.execute("INSERT OR REPLACE INTO state VALUES (1, ?, ?)", (contents.position, contents.marks.verdict))


def _write_take(database: sqlite3.Connection, take: Take) -> None:
    blobs = pack(take.weights), pack(take.lost), pack(take.rotations)
    row = (take.name, take.fps, take.start_s, len(take), *blobs)
    database.execute("INSERT INTO take VALUES (1, ?, ?, ?, ?, ?, ?, ?)", row)
    origin = take.origin
    if isinstance(origin, Origin):
        timecodes = b"\n".join(origin.timecodes)
        lines = len(origin.timecodes), len(timecodes), pack(np.frombuffer(timecodes, "u1"))
        arrays = pack(origin.rows), pack(origin.values), pack(origin.lost)
        how = origin.decimals, origin.newline, int(origin.swapped)
        database.execute(
            "INSERT INTO origin VALUES (1, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
            (json.dumps(origin.header), *lines, *arrays, *how),
        )


def _read_take(database: sqlite3.Connection, budget: Budget) -> Take:
    name, fps, start_s, frames, *blobs = one(
        database, "SELECT name, fps, start_s, frames, weights, lost, rotations FROM take"
    )
    _require(1 <= frames <= MAX_FRAMES and 0 < fps <= MAX_FPS, "its length or frame rate is not possible")
    _require(0 <= start_s <= 2 * DAY_S, "its time of day is not possible")
    weights = unpack(blobs[0], (frames, len(SHAPES)), "<f8", budget)
    rotations = unpack(blobs[2], (frames, ROTATIONS), "<f8", budget)
    _require(bool(np.isfinite(rotations).all()), "a rotation is not a finite number")
    lost = unpack(blobs[1], (frames,), "u1", budget) != 0
    origin = _read_origin(database, frames, budget)
    return Take(weights=weights, fps=fps, lost=lost, rotations=rotations, name=name, start_s=start_s, origin=origin)


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
    _require(bool(np.isfinite(values).all()) and not lost.all(), "a recorded value is not a finite number")
    _require(0 <= decimals <= MAX_DECIMALS and newline in (b"\n", b"\r\n"), "the file it came from is not possible")
    return Origin(names, timecodes, rows.astype(np.int64), values, lost, decimals, newline, bool(swapped))


def _read_edits(database: sqlite3.Connection, length: int, budget: Budget) -> Iterable[Edit]:
    found = database.execute(
        "SELECT place, kind, title, inputs, start, frames, weights, controls, asked FROM edits ORDER BY place"
    )
    for index, (place, kind, title, inputs, start, frames, weights, controls, asked) in enumerate(found):
        _require(place == index and start >= 0 and 0 <= frames <= length - start, "an edit is out of place")
        rows = unpack(weights, (frames, len(SHAPES)), "<f8", budget)
        _require(bool(np.isfinite(rows).all()), "an edit holds a weight that is not a finite number")
        made_from = _json(inputs, budget)
        _require(isinstance(made_from, dict), "an edit does not say what it was made from")
        yield Edit(kind, title, start, rows, _read_asked(asked, _texts(controls, budget), frames, budget), made_from)


def _read_asked(blob: object, names: tuple[str, ...], frames: int, budget: Budget) -> Array:
    """Return asked values in today's columns: a control that is new since has NaN, one that is gone is left out."""
    stored = unpack(blob, (frames, len(names)), "<f8", budget)
    _require(not np.isinf(stored).any(), "an edit asks for a value that is not finite")
    if names == tuple(CONTROL_INDEX):
        return np.asarray(stored, np.float64)
    asked = np.full((frames, len(CONTROLS)), np.nan)
    for column, name in enumerate(names):
        if name in CONTROL_INDEX:
            asked[:, CONTROL_INDEX[name]] = stored[:, column]
    return asked


def _read_marks(database: sqlite3.Connection, verdict: str, length: int, budget: Budget) -> Marks:
    def rows(columns: str, table: str) -> list[Any]:
        return database.execute(f"SELECT {columns} FROM {table} ORDER BY place").fetchall()

    spans = tuple(Span(*row) for row in rows("start, stop, region, kind", "spans"))
    pins = tuple(
        Pin(frame, _pose(weights, budget), start, stop)
        for frame, weights, start, stop in rows("frame, weights, start, stop", "pins")
    )
    notes = tuple(Note(*row) for row in rows("frame, author, time, text", "notes"))
    media = tuple(Media(*row) for row in rows("kind, path, sha256, offset_s", "media"))
    _require(all(0 <= span.start < span.stop <= length for span in spans), "a span is not within the take")
    within = all(0 <= pin.start <= pin.frame < pin.stop <= length for pin in pins)
    _require(within, "a pin is not within the take")
    _require(all(0 <= note.frame < length for note in notes), "a note is not within the take")
    _require(all(bool(np.isfinite(entry.offset_s)) for entry in media), "an offset is not a finite number")
    return Marks(spans, pins, notes, media, verdict)


def _pose(text: str, budget: Budget) -> dict[str, float]:
    pose = _json(text, budget)
    _require(isinstance(pose, dict) and set(pose) <= set(SHAPE_INDEX), "a pin holds no pose")
    values = list(pose.values())
    sound = all(isinstance(value, float | int) and -1e6 < value < 1e6 for value in values)
    _require(sound, "a pin holds no pose")
    return {name: float(value) for name, value in pose.items()}


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
