"""Recordings that a crash cut short: known by their name, read up to their last whole row."""

from __future__ import annotations

from fnmatch import fnmatch
from pathlib import Path

UNFINISHED = "*.partial*.csv"  # what recordings are called until they are whole


def is_unfinished(path: Path) -> bool:
    """Return whether a file is, by its name, a recording that was not ended."""
    return fnmatch(path.name, UNFINISHED)


def whole_rows(content: bytes) -> bytes:
    """Return the rows that were written whole: a crash leaves half a row, or zeros where rows had not reached the disk."""
    rows, newline, _ = content.partition(b"\0")[0].rpartition(b"\n")
    return rows + newline
