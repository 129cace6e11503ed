"""`retake smooth`: a Butterworth filter over a range of frames."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.cli.reading import AUTOMATIC, SAME, Fps, ReadSides, WrittenSides, open_take, save_take
from app.cli.takes import Out, TakeFile
from app.printing import say


def smooth(
    take: TakeFile,
    out: Out,
    cutoff: Annotated[float, typer.Option(help="Cutoff frequency in Hz.")],
    frames: Annotated[str | None, typer.Option(help="First frame and the one after the last; all without it.")] = None,
    fps: Fps = None,
    sides: ReadSides = AUTOMATIC,
    write_sides: WrittenSides = SAME,
) -> None:
    """Low-pass all weights, shifting nothing in time; the range's ends are feathered."""
    from engine import editing

    opened = open_take(Path(take), fps, sides)
    chosen = editing.parse_frames(frames, opened) if frames else (0, len(opened))
    save_take(editing.smooth(opened, editing.SmoothRequest(chosen, cutoff)).apply(opened), out, write_sides)
    say(f"smoothed frames {chosen[0]}:{chosen[1]} at {cutoff:g} Hz; wrote {out}")


def register(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(smooth)
