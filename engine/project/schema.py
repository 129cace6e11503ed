"""The tables of a project file, version by version, and the way from each to the next."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable

from engine.errors import FormatError
from engine.project.migrating import text_from_values

APPLICATION_ID = 0x52544B45  # RTKE
VERSION = 4
NOT_OURS = "Open a .retake file, or a take."
DAMAGED = "Open an older copy of it, or the take itself."
MAX_TABLES = 64

_FIRST = {
    "take": """CREATE TABLE take (
  id INTEGER PRIMARY KEY CHECK (id = 1),
  name TEXT NOT NULL, fps REAL NOT NULL, start_s REAL NOT NULL, frames INTEGER NOT NULL,
  weights BLOB NOT NULL, lost BLOB NOT NULL, rotations BLOB NOT NULL
) STRICT""",
    "origin": """CREATE TABLE origin (
  id INTEGER PRIMARY KEY CHECK (id = 1),
  header TEXT NOT NULL, rows INTEGER NOT NULL, timecode_bytes INTEGER NOT NULL, timecodes BLOB NOT NULL,
  frames BLOB NOT NULL, recorded BLOB NOT NULL, lost BLOB NOT NULL,
  decimals INTEGER NOT NULL, newline BLOB NOT NULL, swapped INTEGER NOT NULL
) STRICT""",
    "edits": """CREATE TABLE edits (
  place INTEGER PRIMARY KEY,
  kind TEXT NOT NULL, title TEXT NOT NULL, inputs TEXT NOT NULL,
  start INTEGER NOT NULL, frames INTEGER NOT NULL,
  weights BLOB NOT NULL, controls TEXT NOT NULL, asked BLOB NOT NULL
) STRICT""",
    "state": """CREATE TABLE state (
  id INTEGER PRIMARY KEY CHECK (id = 1),
  position INTEGER NOT NULL, verdict TEXT NOT NULL
) STRICT""",
    "spans": """CREATE TABLE spans (
  place INTEGER PRIMARY KEY,
  start INTEGER NOT NULL, stop INTEGER NOT NULL, region TEXT NOT NULL, kind TEXT NOT NULL
) STRICT""",
    "notes": """CREATE TABLE notes (
  place INTEGER PRIMARY KEY,
  frame INTEGER NOT NULL, author TEXT NOT NULL, time TEXT NOT NULL, text TEXT NOT NULL
) STRICT""",
    "media": """CREATE TABLE media (
  place INTEGER PRIMARY KEY,
  kind TEXT NOT NULL, path TEXT NOT NULL, sha256 TEXT NOT NULL
) STRICT""",
}
_PINS = """CREATE TABLE pins (
  place INTEGER PRIMARY KEY,
  frame INTEGER NOT NULL, weights TEXT NOT NULL, start INTEGER NOT NULL, stop INTEGER NOT NULL
) STRICT"""
_STATE = """CREATE TABLE state (
  id INTEGER PRIMARY KEY CHECK (id = 1),
  position INTEGER NOT NULL, verdict TEXT NOT NULL, changed TEXT NOT NULL
) STRICT"""
_MEDIA = """CREATE TABLE media (
  place INTEGER PRIMARY KEY,
  kind TEXT NOT NULL, path TEXT NOT NULL, sha256 TEXT NOT NULL, offset_s REAL NOT NULL
) STRICT"""

_ORIGIN = """CREATE TABLE origin (
  id INTEGER PRIMARY KEY CHECK (id = 1),
  rows INTEGER NOT NULL, frames BLOB NOT NULL, lost BLOB NOT NULL, swapped INTEGER NOT NULL
) STRICT"""
_TEXT = """CREATE TABLE origin_text (
  place INTEGER PRIMARY KEY,
  bytes INTEGER NOT NULL, text BLOB NOT NULL
) STRICT"""
_EDITS = """CREATE TABLE edits (
  place INTEGER PRIMARY KEY,
  kind TEXT NOT NULL, title TEXT NOT NULL, inputs TEXT NOT NULL,
  start INTEGER NOT NULL, frames INTEGER NOT NULL,
  weights BLOB NOT NULL, controls TEXT NOT NULL, asked BLOB NOT NULL, lost BLOB
) STRICT"""

_NOTES = """CREATE TABLE notes (
  place INTEGER PRIMARY KEY,
  frame INTEGER NOT NULL, author TEXT NOT NULL, time TEXT NOT NULL, text TEXT NOT NULL,
  frames INTEGER NOT NULL, region TEXT NOT NULL, replies TEXT NOT NULL,
  resolved_by TEXT NOT NULL, resolved_at TEXT NOT NULL, drawing TEXT NOT NULL
) STRICT"""
_VERDICTS = """CREATE TABLE verdicts (
  place INTEGER PRIMARY KEY,
  judgement TEXT NOT NULL, why TEXT NOT NULL, author TEXT NOT NULL, time TEXT NOT NULL
) STRICT"""
_DISMISSALS = """CREATE TABLE dismissals (
  place INTEGER PRIMARY KEY,
  kind TEXT NOT NULL, start INTEGER NOT NULL, stop INTEGER NOT NULL, weight REAL NOT NULL, sentence TEXT NOT NULL,
  author TEXT NOT NULL, time TEXT NOT NULL, why TEXT NOT NULL
) STRICT"""
_FLAGS = """CREATE TABLE flags (
  place INTEGER PRIMARY KEY,
  kind TEXT NOT NULL, counts INTEGER, threshold REAL
) STRICT"""
_POSITION = """CREATE TABLE state (
  id INTEGER PRIMARY KEY CHECK (id = 1),
  position INTEGER NOT NULL, changed TEXT NOT NULL
) STRICT"""

_SECOND = {**_FIRST, "pins": _PINS, "media": _MEDIA, "state": _STATE}
_THIRD = {**_SECOND, "origin": _ORIGIN, "origin_text": _TEXT, "edits": _EDITS}
_REVIEWED = {"notes": _NOTES, "verdicts": _VERDICTS, "dismissals": _DISMISSALS, "flags": _FLAGS, "state": _POSITION}
_FOURTH = {**_THIRD, **_REVIEWED}
SCHEMAS: dict[int, dict[str, str]] = {1: _FIRST, 2: _SECOND, 3: _THIRD, 4: _FOURTH}
# From each version to the next. A table is made anew and never altered, so that its text is that of a new file.
MIGRATIONS: dict[int, tuple[str | Callable[[sqlite3.Connection], None], ...]] = {
    1: (
        _PINS,
        "ALTER TABLE media RENAME TO media_1",
        _MEDIA,
        "INSERT INTO media SELECT place, kind, path, sha256, 0.0 FROM media_1",
        "DROP TABLE media_1",
        "ALTER TABLE state RENAME TO state_1",
        _STATE,
        "INSERT INTO state SELECT id, position, verdict, strftime('%Y-%m-%dT%H:%M:%SZ', 'now') FROM state_1",
        "DROP TABLE state_1",
    ),
    2: (
        "ALTER TABLE edits RENAME TO edits_2",
        _EDITS,
        "INSERT INTO edits SELECT *, NULL FROM edits_2",
        "DROP TABLE edits_2",
        "ALTER TABLE origin RENAME TO origin_2",
        _ORIGIN,
        _TEXT,
        text_from_values,
        "DROP TABLE origin_2",
    ),
    3: (
        "ALTER TABLE notes RENAME TO notes_3",
        _NOTES,
        "INSERT INTO notes SELECT place, frame, author, time, text, 1, 'face', '[]', '', '', 'null' FROM notes_3",
        "DROP TABLE notes_3",
        _VERDICTS,
        _DISMISSALS,
        _FLAGS,
        "INSERT INTO verdicts SELECT 0, substr(verdict, 1, instr(verdict || ': ', ': ') - 1), "
        "substr(verdict, instr(verdict || ': ', ': ') + 2), '', '' FROM state WHERE verdict <> ''",
        "ALTER TABLE state RENAME TO state_3",
        _POSITION,
        "INSERT INTO state SELECT id, position, changed FROM state_3",
        "DROP TABLE state_3",
    ),
}


def build(database: sqlite3.Connection) -> None:
    """Make the tables of the newest version in an empty database."""
    database.execute(f"PRAGMA application_id = {APPLICATION_ID}")
    database.execute(f"PRAGMA user_version = {VERSION}")
    for statement in SCHEMAS[VERSION].values():
        database.execute(statement)


def check(database: sqlite3.Connection, name: str) -> int:
    """Return the version of a project file; raises `FormatError` unless it is one, to the letter.

    A file from elsewhere may bring views, triggers and columns that compute; none is ever run, since any table that
    is not exactly as this program writes it is refused.
    """
    if database.execute("PRAGMA application_id").fetchone()[0] != APPLICATION_ID:
        raise FormatError(f"{name} is not a Retake project.", NOT_OURS)
    version: int = database.execute("PRAGMA user_version").fetchone()[0]
    if version > VERSION:
        raise FormatError(f"{name} was made by a newer Retake.", "Update Retake to open it.")
    found = database.execute("SELECT type, name, sql FROM sqlite_master LIMIT ?", (MAX_TABLES,)).fetchall()
    expected = {("table", table, text) for table, text in SCHEMAS.get(version, {}).items()}
    if not expected or set(found) != expected:
        raise FormatError(f"{name} holds other tables than a Retake project.", NOT_OURS)
    fault = database.execute("PRAGMA quick_check(1)").fetchone()[0]
    if fault != "ok":
        raise FormatError(f"{name} is damaged.", DAMAGED)
    return version


def migrate(database: sqlite3.Connection, version: int) -> None:
    """Bring a checked file to the newest version, whole or not at all."""
    if version == VERSION:
        return
    database.execute("BEGIN IMMEDIATE")
    try:
        for step in range(version, VERSION):
            for statement in MIGRATIONS[step]:
                if isinstance(statement, str):
                    database.execute(statement)
                else:
                    statement(database)
        database.execute(f"PRAGMA user_version = {VERSION}")
        database.execute("COMMIT")
    except BaseException:
        database.execute("ROLLBACK")
        raise
