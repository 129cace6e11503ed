"""`retake evaluate` and `retake bench`: tables of figures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from app import printing
from app.cli.listing import listing
from engine.errors import EngineError


def show(title: str, rows: Sequence[dict[str, Any]], *, as_json: bool) -> None:
    """Print rows as one JSON object or as a table to read."""
    if as_json:
        printing.as_json({"table": title, "rows": rows})
    else:
        printing.table(title, rows)


def evaluate(
    name: Annotated[str, typer.Argument(help="Which table.")],
    data: Annotated[Path | None, typer.Option(help="A folder of takes instead of the test split.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    figures: Annotated[Path | None, typer.Option(help="Draw the figures into this folder.")] = None,
) -> None:
    """Measure a method against its baselines."""
    from engine.lab.evaluate.tables import named

    if data is not None and not data.is_dir():
        raise EngineError(f"{data} is not a folder.", "Name a folder of takes with --data.")
    table = named(name)
    if figures is not None:
        for path in table.draw(data, figures, printing.remark):
            printing.remark(f"wrote {path}")
    show(name, table.table(data, printing.remark), as_json=as_json)


def bench(as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False) -> None:
    """Measure how fast everything is on this machine, each figure beside its goal."""
    from app.bench.measure import measure

    show("bench", measure(printing.remark), as_json=as_json)


def _names() -> list[str]:
    from engine.lab.evaluate.tables import TABLES

    return [table.name for table in TABLES]


def register(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command(cls=listing(_names, "Which table"))(evaluate)
    app.command()(bench)
