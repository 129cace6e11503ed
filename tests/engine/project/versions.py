"""Project files as older versions wrote them: never to be changed, since there are such files."""

from __future__ import annotations

# A file as the first version wrote it. Never to be changed: there are such files.
FIRST_VERSION = """
PRAGMA application_id = 1381256005;
PRAGMA user_version = 1;
CREATE TABLE take (
  id INTEGER PRIMARY KEY CHECK (id = 1),
  name TEXT NOT NULL, fps REAL NOT NULL, start_s REAL NOT NULL, frames INTEGER NOT NULL,
  weights BLOB NOT NULL, lost BLOB NOT NULL, rotations BLOB NOT NULL
) STRICT;
CREATE TABLE origin (
  id INTEGER PRIMARY KEY CHECK (id = 1),
  header TEXT NOT NULL, rows INTEGER NOT NULL, timecode_bytes INTEGER NOT NULL, timecodes BLOB NOT NULL,
  frames BLOB NOT NULL, recorded BLOB NOT NULL, lost BLOB NOT NULL,
  decimals INTEGER NOT NULL, newline BLOB NOT NULL, swapped INTEGER NOT NULL
) STRICT;
CREATE TABLE edits (
  place INTEGER PRIMARY KEY,
  kind TEXT NOT NULL, title TEXT NOT NULL, inputs TEXT NOT NULL,
  start INTEGER NOT NULL, frames INTEGER NOT NULL,
  weights BLOB NOT NULL, controls TEXT NOT NULL, asked BLOB NOT NULL
) STRICT;
CREATE TABLE state (
  id INTEGER PRIMARY KEY CHECK (id = 1),
  position INTEGER NOT NULL, verdict TEXT NOT NULL
) STRICT;
CREATE TABLE spans (
  place INTEGER PRIMARY KEY,
  start INTEGER NOT NULL, stop INTEGER NOT NULL, region TEXT NOT NULL, kind TEXT NOT NULL
) STRICT;
CREATE TABLE notes (
  place INTEGER PRIMARY KEY,
  frame INTEGER NOT NULL, author TEXT NOT NULL, time TEXT NOT NULL, text TEXT NOT NULL
) STRICT;
CREATE TABLE media (
  place INTEGER PRIMARY KEY,
  kind TEXT NOT NULL, path TEXT NOT NULL, sha256 TEXT NOT NULL
) STRICT;
"""


# As the second version wrote it. Never to be changed either.
SECOND_VERSION = (
    FIRST_VERSION.replace("user_version = 1", "user_version = 2")
    .replace(
        "position INTEGER NOT NULL, verdict TEXT NOT NULL",
        "position INTEGER NOT NULL, verdict TEXT NOT NULL, changed TEXT NOT NULL",
    )
    .replace("sha256 TEXT NOT NULL", "sha256 TEXT NOT NULL, offset_s REAL NOT NULL")
    + """
CREATE TABLE pins (
  place INTEGER PRIMARY KEY,
  frame INTEGER NOT NULL, weights TEXT NOT NULL, start INTEGER NOT NULL, stop INTEGER NOT NULL
) STRICT;
"""
)
