"""How far a command is, as lines on the error stream."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Annotated

import typer

from app.printing import remark

Shown = Annotated[
    bool | None,
    typer.Option(
        "--progress/--no-progress",
        help="Tell how far it is, a line for each percent; by itself only in a terminal, for each tenth.",
        show_default=False,
    ),
]
PERCENT, TENTH = 1, 10


def telling(what: str, shown: bool | None) -> Callable[[int, int], None]:
    """Return a function of the amount done and the whole that prints the share in percent: ``drawing: 10 %``."""
    step = PERCENT if shown else TENTH if shown is None and sys.stderr.isatty() else 0
    last_percent = 0

    def tell(done: int, of: int) -> None:
        nonlocal last_percent
        percent = 100 * done // max(1, of)
        if step and percent >= last_percent + step:
            last_percent = percent - percent % step
            remark(f"{what}: {last_percent} %")

    return tell
