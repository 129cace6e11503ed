"""The command line: one module per family of verbs, each with `register(app)`."""

from __future__ import annotations

import logging
from typing import Annotated, cast

import typer

from app.cli import blind, character, clean, fill, flags, render, review, smooth, spacetime, tables, takes, training
from app.cli.checks import check_all
from app.cli.outputs import protect_inputs
from app.printing import remark, say
from app.settings import log_path, start_log
from engine.errors import EngineError

UsageError = cast("type[typer.BadParameter]", typer.BadParameter.__mro__[1])  # of whichever click typer brings
FAMILIES = (takes, render, flags, review, fill, smooth, spacetime, clean, character, tables, blind, training)


def build() -> typer.Typer:
    """Return the whole command line."""
    app = typer.Typer(
        name="retake",
        help="Edit a facial performance without reshooting it.",
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
    )
    app.callback()(_start)
    for family in FAMILIES:
        family.register(app)
    check_all(app)
    return protect_inputs(app)


def _tell_version(wanted: bool) -> None:
    if wanted:
        from app.dialogs.about import describe

        say(describe())
        raise typer.Exit


def _start(
    version: Annotated[
        bool, typer.Option("--version", help="Say which version this is.", callback=_tell_version, is_eager=True)
    ] = False,
) -> None:
    """Edit a facial performance without reshooting it."""


def names() -> set[str]:
    """Return the names of all commands."""
    return {command.name or command.callback.__name__ for command in build().registered_commands if command.callback}


def run(arguments: list[str]) -> int:
    """Run one command; returns its exit code, 2 with one sentence on the error stream for what the user can mend."""
    try:
        code = build()(args=arguments, prog_name="retake", standalone_mode=False)
        return code if isinstance(code, int) else 0
    except UsageError as error:  # typer would print the words of the command line as they are
        remark(f"{error.format_message()} Help is given by: retake COMMAND --help")
        return 2
    except EngineError as error:
        remark(error)
        return 2
    except KeyboardInterrupt:
        return 130
    except Exception as error:  # no traceback ever reaches the user; the log gets it
        start_log()
        logging.getLogger("app").exception("uncaught")
        remark(f"Something went wrong: {error or type(error).__name__}. {log_path()} has more.")
        return 1
    except SystemExit as done:
        return done.code if isinstance(done.code, int) else 1
