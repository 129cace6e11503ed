"""`retake smooth`: a Butterworth filter over a range of frames."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.cli.takes import Out, TakeFile
from app.printing import say
from engine.formats import read_take, write_take


def smooth(
    take: TakeFile,
    out: Out,
    cutoff: Annotated[float, typer.Option(help="Cutoff frequency in Hz.")],
    frames: Annotated[str | None, typer.Option(help="First frame and the one after the last; all without it.")] = None,
) -> None:
    """Low-pass all weights, shifting nothing in time; the range's ends are feathered."""
    from engine import retouch
    from engine.editing import parse_frames

    opened = read_take(Path(take))
    chosen = parse_frames(frames, opened) if frames else (0, len(opened))
    write_take(retouch.smooth(opened, chosen, cutoff).apply(opened), out)
    say(f"smoothed frames {chosen[0]}:{chosen[1]} at {cutoff:g} Hz; wrote {out}")


def register(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(smooth)
