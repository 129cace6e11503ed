"""The only place that prints: what comes from files and packets never moves the cursor, colours or styles anything."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from engine.words import terminal


def say(text: object, *, end: str = "\n") -> None:
    """Print text for the user."""
    _write(sys.stdout, terminal(str(text)) + end)


def remark(text: object) -> None:
    """Print what the user should know but a pipe should not get, on the error stream."""
    _write(sys.stderr, terminal(str(text)) + "\n")


def as_json(value: Mapping[str, Any]) -> None:
    """Print one JSON object in one line of ASCII."""
    _write(sys.stdout, json.dumps(value) + "\n")


def table(title: str, rows: Sequence[dict[str, Any]]) -> None:
    """Print rows as a table, or several where a terminal is too narrow for all their columns."""
    console = Console(markup=False, emoji=False, highlight=False)
    for columns in _fitting(rows, console.width):
        shown = Table(title=Text(terminal(title), style="italic"))
        for name in columns:
            shown.add_column(_cell(name), overflow="fold")
        for row in rows:
            shown.add_row(*(_cell(row.get(name)) for name in columns))
        console.print(shown)


def _write(stream: Any, text: str) -> None:
    """Write text; characters that the terminal cannot show become escapes."""
    encoding = getattr(stream, "encoding", None) or "utf-8"
    stream.write(text.encode(encoding, "backslashreplace").decode(encoding))
    stream.flush()


def _fitting(rows: Sequence[dict[str, Any]], width: int) -> list[list[str]]:
    """Share the columns out to tables that are no wider than a terminal, each with the words that name its rows."""
    columns = list(dict.fromkeys(name for row in rows for name in row))
    wide = {name: 3 + max(len(name), *(len(_cell(row.get(name))) for row in rows)) for name in columns}
    names = [name for name in columns if any(isinstance(row.get(name), str) for row in rows)]
    tables, room = [list(names)], width - 1 - sum(wide[name] for name in names)
    left = room
    for name in columns:
        if name in names:
            continue
        if wide[name] > left and len(tables[-1]) > len(names):
            tables.append(list(names))
            left = room
        tables[-1].append(name)
        left -= wide[name]
    return tables


def _cell(value: Any) -> Text:
    """Return a cell: text of a file, so neither markup nor emoji codes count in it."""
    if isinstance(value, float):
        return Text(f"{value:.4g}")
    return Text("" if value is None else terminal(str(value)))
