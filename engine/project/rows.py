"""Records to rows and back; whatever a file says is checked before it is believed."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Callable, Iterable
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import numpy as np

from engine.controls import ALL_CONTROLS, ALL_INDEX
from engine.errors import EngineError
from engine.formats.livelink import MAX_COLUMNS
from engine.formats.livelink.timecode import DAY_S
from engine.project.blobs import Budget, DamagedError, pack, unpack
from engine.project.mark_rows import read_marks, read_verdict, write_marks
from engine.project.origins import read_origin, write_origin
from engine.project.records import (
    ALIGN,
    MARK,
    READING,
    Contents,
    Edit,
    Marks,
    Summary,
    marks_of,
    read_as_of,
)
from engine.project.soundness import MAX_NAME, MAX_WEIGHT, moment, require, require_marks, require_visemes
from engine.project.tables import insert, one, read_json
from engine.take import SHAPES, Array, Take

MAX_FRAMES = 1_000_000  # over four hours at 60 fps
MIN_FPS, MAX_FPS = 0.01, 10_000.0
MAX_EDITS = 10_000_000  # they are counted against the memory, too
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
        require_visemes(edits)
        (position,) = one(database, "SELECT position FROM state")
        require(0 <= position <= len(edits), "its place in the undo history is not there")
        return Contents(take, edits, position, read_marks(database, len(take), budget))
    except EngineError as error:
        raise DamagedError(error.sentence.rstrip(".")) from error


def read_summary(database: sqlite3.Connection) -> Summary:
    """Return what a checked file is; raises `DamagedError`."""
    name, frames, fps = one(database, "SELECT name, frames, fps FROM take")
    position, changed = one(database, "SELECT position, changed FROM state")
    require(1 <= frames <= MAX_FRAMES and MIN_FPS <= fps <= MAX_FPS, "its length or frame rate is not possible")
    require(len(name) <= MAX_NAME, "its name is too long")
    return Summary(name, frames, fps, position, moment(changed), read_verdict(database))


def write_edits(database: sqlite3.Connection, first: int, edits: Iterable[Edit]) -> None:
    """Let these edits follow the first so many, in place of what came after."""
    database.execute("DELETE FROM edits WHERE place >= ?", (first,))
    names = json.dumps([control.name for control in ALL_CONTROLS])
    for place, edit in enumerate(edits, first):
        inputs = json.dumps(dict(edit.inputs), default=_plain)
        lost = None if edit.lost is None else pack(edit.lost)
        blobs = pack(edit.weights), names, pack(edit.asked), lost
        insert(database, "edits", (place, edit.kind, edit.title, inputs, edit.start, len(edit.weights), *blobs))


def write_state(database: sqlite3.Connection, contents: Contents) -> None:
    """Write the place in the undo history, and that it is so from now on."""
    row = contents.position, datetime.now(UTC).isoformat(timespec="seconds")
    database.execute("INSERT OR REPLACE INTO state VALUES (1, ?, ?)", row)


def _write_take(database: sqlite3.Connection, take: Take) -> None:
    blobs = pack(take.weights), pack(take.lost), pack(take.rotations)
    insert(database, "take", (1, take.name, take.fps, take.start_s, len(take), *blobs))
    write_origin(database, take)


def _read_take(database: sqlite3.Connection, budget: Budget) -> Take:
    name, fps, start_s, frames, *blobs = one(
        database, "SELECT name, fps, start_s, frames, weights, lost, rotations FROM take"
    )
    require(1 <= frames <= MAX_FRAMES and MIN_FPS <= fps <= MAX_FPS, "its length or frame rate is not possible")
    require(len(name) <= MAX_NAME, "its name is too long")
    require(0 <= start_s <= 2 * DAY_S, "its time of day is not possible")
    weights = unpack(blobs[0], (frames, len(SHAPES)), "<f8", budget)
    rotations = unpack(blobs[2], (frames, ROTATIONS), "<f8", budget)
    require(_possible(weights) and _possible(rotations), "a weight or rotation is not a finite number")
    lost = unpack(blobs[1], (frames,), "u1", budget) != 0
    take = Take(weights=weights, fps=fps, lost=lost, rotations=rotations, name=name, start_s=start_s)
    return replace(take, origin=read_origin(database, take, budget))


def _possible(values: Array) -> bool:
    return bool((np.abs(values) <= MAX_WEIGHT).all())


def _read_edits(database: sqlite3.Connection, length: int, budget: Budget) -> Iterable[Edit]:
    found = database.execute(
        "SELECT place, kind, title, inputs, start, frames, lost, weights, controls, asked FROM edits ORDER BY place"
    )
    for index, (place, kind, title, inputs, start, frames, lost, weights, controls, asked) in enumerate(found):
        require(index < MAX_EDITS and len(kind) <= MAX_NAME and len(title) <= MAX_NAME, "an edit is not described")
        require(place == index and start >= 0 and 0 <= frames <= length - start, "an edit is out of place")
        rows = unpack(weights, (frames, len(SHAPES)), "<f8", budget)
        require(_possible(rows), "an edit holds a weight that is not a finite number")
        made_from = read_json(inputs, budget)
        require(isinstance(made_from, dict), "an edit does not say what it was made from")
        if kind == MARK:
            for marks in ("before", "after"):
                require_marks(_marks_in(made_from, marks), length)
        require(kind != ALIGN or frames == length, "the take before is not whole")
        if kind == READING:
            _require_readings(made_from)
        asked_rows = _read_asked(asked, _texts(controls, budget), frames, budget)
        still = None if lost is None else unpack(lost, (frames,), "u1", budget) != 0
        yield Edit(kind, title, start, rows, asked_rows, made_from, still)


def _read_asked(blob: object, names: tuple[str, ...], frames: int, budget: Budget) -> Array:
    """Return asked values in today's columns: a control that is new since has NaN, one that is gone is left out."""
    stored = unpack(blob, (frames, len(names)), "<f8", budget)
    require(not np.isinf(stored).any(), "an edit asks for a value that is not finite")
    if names == tuple(ALL_INDEX):
        return np.asarray(stored, np.float64)
    asked = np.full((frames, len(ALL_CONTROLS)), np.nan)
    for column, name in enumerate(names):
        if name in ALL_INDEX:
            asked[:, ALL_INDEX[name]] = stored[:, column]
    return asked


def _marks_in(inputs: dict[str, Any], name: str) -> Marks:
    try:
        return marks_of(inputs[name])
    except (KeyError, TypeError) as error:
        raise DamagedError("an edit does not say what it marked") from error


def _require_readings(inputs: dict[str, Any]) -> None:
    try:
        for which in ("before", "after"):
            read_as_of(inputs[which])
    except (KeyError, TypeError, ValueError, OverflowError, EngineError) as error:
        raise DamagedError("an edit does not say how the take is read") from error


def _texts(text: str, budget: Budget) -> tuple[str, ...]:
    names = read_json(text, budget)
    require(isinstance(names, list) and all(isinstance(name, str) for name in names), "a list of names is damaged")
    require(len(names) <= MAX_COLUMNS, "a list of names is too long")
    return tuple(names)


def _plain(value: object) -> object:
    """Return a numpy number or array as JSON can hold it."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} cannot be kept with an edit")
