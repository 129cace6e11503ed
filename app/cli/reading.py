"""The options of every command that reads a take: its rate and its sides, and those of every command that writes one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, cast

import typer

from engine.formats import read_take, write_take
from engine.formats.base.reading import Reading, Sides
from engine.take import Take

Fps = Annotated[
    float | None, typer.Option("--fps", help="Frames per second, in place of those that its timecodes tell.")
]
ReadSides = Annotated[
    str,
    typer.Option(
        "--sides",
        help="Whose left and right of mouth and jaw the file names: recorded (exchanged, as the app does), named, or "
        "automatic (by the motion).",
    ),
]
WrittenSides = Annotated[
    str,
    typer.Option("--write-sides", help="The same for what is written: recorded, named, or same (as they were read)."),
]
AUTOMATIC, SAME = "automatic", "same"


def sides_of(text: str) -> Sides:
    """Return the choice that a text names; the words of the window are understood as well."""
    word = text.strip().lower().replace("_", "-").replace(" ", "-").removeprefix("as-")
    return cast(Sides, {"the-app-records": "recorded", "app": "recorded", SAME: AUTOMATIC}.get(word, word))


def open_take(path: Path, fps: float | None = None, sides: str = AUTOMATIC) -> Take:
    """Read a take with what the command line says of its rate and sides; raises `EngineError`."""
    return read_take(path, reading=Reading(fps, sides_of(sides)))


def save_take(take: Take, path: Path, sides: str = SAME) -> None:
    """Write a take with the sides that the command line asks for; raises `EngineError`."""
    write_take(take, path, Reading(sides=sides_of(sides)).sides)
