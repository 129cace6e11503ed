"""Guards the output files of every command: none overwrites what it reads, unless an option allows it."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from engine.formats.base import inputs
from engine.formats.base.atomic import writable

OUTPUTS = frozenset({"out", "record", "key", "findings", "for_editors"})  # what commands call the files that they write
GOES_ON = frozenset({"train"})  # from what it wrote before
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Let the result take the place of a file that is read.")]


def protect_inputs(app: typer.Typer) -> typer.Typer:
    """Give each command that writes, those of groups too, the option `--overwrite` and the check it lifts."""
    for command in app.registered_commands:
        run = command.callback
        if run is not None and run.__name__ not in GOES_ON and OUTPUTS & set(inspect.signature(run).parameters):
            command.callback = _protected(run)
    for group in app.registered_groups:
        if group.typer_instance is not None:
            protect_inputs(group.typer_instance)
    return app


def _protected(run: Callable[..., Any]) -> Callable[..., Any]:
    @functools.wraps(run)
    def protected(*, overwrite: bool, **values: Any) -> Any:
        with inputs.protected(allowed=overwrite):
            paths = {name: value for name, value in values.items() if isinstance(value, Path)}
            for path in (path for name, path in paths.items() if name not in OUTPUTS):
                inputs.note(path)
            for path in (path for name, path in paths.items() if name in OUTPUTS):
                _check(path)
            return run(**values)

    own = inspect.signature(run, eval_str=True)
    option = inspect.Parameter("overwrite", inspect.Parameter.KEYWORD_ONLY, default=False, annotation=Overwrite)
    shown = own.replace(parameters=[*own.parameters.values(), option])
    protected.__signature__ = shown  # type: ignore[attr-defined]
    protected.__annotations__ = {name: parameter.annotation for name, parameter in shown.parameters.items()}
    return protected


def _check(path: Path) -> None:
    """Refuse now what would be refused after the work."""
    if path.is_dir():
        inputs.refuse(path)
    else:
        writable(path)
