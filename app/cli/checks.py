"""What every command checks before it begins: numbers are finite, and what shall be written has an ending and a folder."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any

import typer

from engine.errors import EditError, EngineError
from engine.formats import format_of

# By the name of a command's function and of its argument: the endings that its writer knows; takes by their own table.
TAKE = ("take",)
FOLDER = ("folder",)
ANY = ("any",)
OUTPUTS: dict[tuple[str, str], tuple[str, ...]] = {
    **{(name, "out"): TAKE for name in ("edit", "fill", "smooth", "clean", "pin", "retarget")},
    ("live", "record"): TAKE,
    ("render", "out"): (".png", ".mp4"),
    ("drive", "out"): (".glb", ".usd", ".usda", ".usdc", ".npz"),
    ("flags", "out"): ANY,
    ("import_", "out"): ANY,
    ("landmarks_", "out"): ANY,
    ("make", "out"): FOLDER,
    ("make", "key"): ANY,
    ("train", "out"): FOLDER,
    ("review", "findings"): (".csv", ".json"),
    ("review", "for_editors"): (".edl", ".csv"),
    ("review", "out"): FOLDER,  # or a report, which the command itself checks first
}


def check_all(app: typer.Typer) -> None:
    """Let each command of a command line, and of its families, check what it is given before it begins."""
    for command in app.registered_commands:
        if command.callback is not None:
            command.callback = _checked(command.callback)
    for family in app.registered_groups:
        if family.typer_instance is not None:
            check_all(family.typer_instance)


def _checked(command: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(command)
    def checked(**given: Any) -> Any:
        for name, value in given.items():
            if isinstance(value, float) and not math.isfinite(value):
                raise EditError(f"--{name.strip('_').replace('_', '-')} must be a finite number, not {value:g}.")
            kinds = OUTPUTS.get((command.__name__, name))
            if kinds is not None and isinstance(value, Path):
                require_writable(value, kinds)
        return command(**given)

    return checked


def require_writable(path: Path, endings: tuple[str, ...]) -> None:
    """Raise `EngineError` where no file of these endings can be written to a path: better now than after the work."""
    if endings == FOLDER:
        return
    if endings == TAKE:
        format_of(path)
    elif endings != ANY and path.suffix.lower() not in endings:
        known = ", ".join(endings)
        raise EditError(f"{path.name} is not a kind of file that can be written here.", f"Use one of: {known}.")
    if path.is_dir():
        raise EngineError(f"{path.name} is a folder.", "Name a file in it.")
    if not path.parent.is_dir():
        raise EngineError(
            f"{path.name} could not be written: there is no folder {path.parent}.", "Make the folder first."
        )
