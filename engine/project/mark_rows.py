"""What people put beside the curves, to rows and back."""

from __future__ import annotations

import json
import sqlite3
from dataclasses import asdict
from typing import Any

from engine.project.blobs import Budget, DamagedError
from engine.project.records import Marks, Media, Pin, Span
from engine.project.reviewing import Note, Verdict, drawing_of, replies_of
from engine.project.soundness import MAX_MARKS, require, require_marks, require_verdict
from engine.project.tables import read_json
from engine.quality.settings import Dismissal, FlagSettings

_VERDICT = "SELECT judgement, why, author, time FROM verdicts ORDER BY place"


def write_marks(database: sqlite3.Connection, marks: Marks) -> None:
    """Put all marks in place of those that are there."""
    rows: dict[str, list[tuple[object, ...]]] = {
        "spans": [(span.start, span.stop, span.region, span.kind) for span in marks.spans],
        "pins": [(pin.frame, json.dumps(dict(pin.weights)), pin.start, pin.stop) for pin in marks.pins],
        "notes": [_note_row(note) for note in marks.notes],
        "media": [(media.kind, media.path, media.sha256, media.offset_s) for media in marks.media],
        "verdicts": [(each.judgement, each.why, each.author, each.time) for each in marks.verdicts],
        "dismissals": [tuple(asdict(each).values()) for each in marks.dismissals],
        "flags": _flag_rows(marks.flags),
    }
    for table, written in rows.items():
        database.execute(f"DELETE FROM {table}")
        if written:
            places = ", ".join("?" for _ in (0, *written[0]))
            numbered = [(place, *row) for place, row in enumerate(written)]
            database.executemany(f"INSERT INTO {table} VALUES ({places})", numbered)


def read_marks(database: sqlite3.Connection, length: int, budget: Budget) -> Marks:
    """Return the marks of a take of so many frames; raises `DamagedError` for what cannot be."""

    def rows(columns: str, table: str) -> list[Any]:
        return database.execute(f"SELECT {columns} FROM {table} ORDER BY place LIMIT {MAX_MARKS + 1}").fetchall()

    marks = Marks(
        spans=tuple(Span(*row) for row in rows("start, stop, region, kind", "spans")),
        pins=tuple(
            Pin(frame, read_json(weights, budget), start, stop)
            for frame, weights, start, stop in rows("frame, weights, start, stop", "pins")
        ),
        notes=tuple(
            _note(row, budget)
            for row in rows(
                "frame, author, time, text, frames, region, replies, resolved_by, resolved_at, drawing", "notes"
            )
        ),
        media=tuple(Media(*row) for row in rows("kind, path, sha256, offset_s", "media")),
        verdicts=tuple(Verdict(*row) for row in rows("judgement, why, author, time", "verdicts")),
        dismissals=tuple(
            Dismissal(*row) for row in rows("kind, start, stop, weight, sentence, author, time, why", "dismissals")
        ),
        flags=_settings(rows("kind, counts, threshold", "flags")),
    )
    require_marks(marks, length)
    return marks


def read_verdict(database: sqlite3.Connection) -> Verdict | None:
    """Return the verdict that counts, without reading anything else; None where there is none."""
    row = database.execute(f"{_VERDICT} DESC LIMIT 1").fetchone()
    if row is None:
        return None
    verdict = Verdict(*row)
    require_verdict(verdict)
    return verdict if verdict.judgement else None


def _note_row(note: Note) -> tuple[object, ...]:
    replies = json.dumps([asdict(reply) for reply in note.replies])
    drawing = json.dumps(None if note.drawing is None else asdict(note.drawing))
    row_values = note.frame, note.author, note.time, note.text, note.frames, note.region
    return *row_values, replies, note.resolved_by, note.resolved_at, drawing


def _note(row: tuple[Any, ...], budget: Budget) -> Note:
    frame, author, time, text, frames, region, replies, resolved_by, resolved_at, drawing = row
    try:
        answers, lines = replies_of(read_json(replies, budget)), drawing_of(read_json(drawing, budget))
    except (KeyError, TypeError) as error:
        raise DamagedError("a note has a reply or a drawing that is none") from error
    return Note(frame, author, time, text, frames, region, answers, resolved_by, resolved_at, lines)


def _flag_rows(settings: FlagSettings) -> list[tuple[object, ...]]:
    return [
        (kind, settings.counts.get(kind), settings.thresholds.get(kind))
        for kind in sorted({*settings.counts, *settings.thresholds})
    ]


def _settings(rows: list[tuple[Any, ...]]) -> FlagSettings:
    require(all(counts in (0, 1, None) for _, counts, _ in rows), "a kind of flag neither counts nor does not")
    return FlagSettings(
        {kind: bool(counts) for kind, counts, _ in rows if counts is not None},
        {kind: threshold for kind, _, threshold in rows if threshold is not None},
    )
