"""Commands whose help lists what their first argument may be, found only when help is asked for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from typer.core import TyperCommand


def listing(names: Callable[[], list[str]], what: str) -> type[TyperCommand]:
    """Return a kind of command that completes its first argument's help with names: to know them brings torch along."""

    class Listing(TyperCommand):
        def format_help(self, ctx: Any, formatter: Any) -> None:
            self.params[0].help = f"{what}: {', '.join(names())}."  # type: ignore[attr-defined]  # it is an argument
            super().format_help(ctx, formatter)

    return Listing
