"""`retake evaluate` and `retake bench`: tables of figures."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from engine import evaluate as tables
from engine.errors import EngineError

errors = Console(stderr=True)


def show(title: str, rows: Sequence[dict[str, Any]], *, as_json: bool) -> None:
    """Print rows as one JSON object or as a table to read."""
    if as_json:
        print(json.dumps({"table": title, "rows": rows}))
        return
    console = Console()
    for columns in _fitting(rows, console.width):
        shown = Table(title=title)
        for name in columns:
            shown.add_column(name, overflow="fold")
        for row in rows:
            shown.add_row(*(_cell(row.get(name)) for name in columns))
        console.print(shown)


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


def _cell(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.4g}"
    return "" if value is None else str(value)


def evaluate(
    name: Annotated[str, typer.Argument(help=f"Which table: {', '.join(tables.TABLES)}.")],
    data: Annotated[Path | None, typer.Option(help="A folder of takes instead of the test split.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    figures: Annotated[Path | None, typer.Option(help="Draw the figures into this folder.")] = None,
) -> None:
    """Measure a method against its baselines."""
    if data is not None and not data.is_dir():
        raise EngineError(f"{data} is not a folder.", "Name a folder of takes with --data.")

    def report(line: str) -> None:
        errors.print(line, style="dim", highlight=False)

    if figures is not None:
        for path in tables.figures(name, data, figures, report):
            report(f"wrote {path}")
    show(name, tables.table(name, data, report), as_json=as_json)


def bench(as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False) -> None:
    """Measure how fast everything is on this machine, each figure beside its goal."""
    from app.bench.measure import measure

    show("bench", measure(lambda line: errors.print(line, style="dim")), as_json=as_json)


def register(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(evaluate)
    app.command()(bench)
