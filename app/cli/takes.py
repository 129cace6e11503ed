"""`retake info` and `retake edit`: what is done with one take."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.cli.reading import AUTOMATIC, SAME, Fps, ReadSides, WrittenSides, open_take, save_take
from app.cli.tables import show
from app.printing import say
from engine.errors import EditError
from engine.take import runs, timecode
from engine.words import counted

TakeFile = Annotated[
    Path, typer.Argument(help="A take: a Live Link Face CSV, folder or zip, or a project.", show_default=False)
]
Out = Annotated[Path, typer.Option("-o", "--out", help="The file to write.", show_default=False)]


def info(
    take: TakeFile,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    fps: Fps = None,
    sides: ReadSides = AUTOMATIC,
) -> None:
    """Say what a take holds: length, rate, lost spans, the reach of its controls."""
    from engine.controls import ALL_CONTROLS
    from engine.extended import bundled_face
    from engine.formats import livelink
    from engine.formats.base.reading import Reading
    from engine.formats.livelink.importing import imported, in_words

    opened = open_take(take, fps, sides)
    measured = bundled_face().measure(opened.weights)
    rows = [
        {"name": control.name, "unit": control.unit, "lowest": float(curve.min()), "highest": float(curve.max())}
        for control, curve in zip(ALL_CONTROLS, measured.T, strict=True)
    ]
    rows += [{"name": "lost", "unit": "frames", "lowest": float(a), "highest": float(b)} for a, b in runs(opened.lost)]
    if not as_json:
        say(
            f"{opened.name}: {counted(len(opened), 'frame')} at {opened.fps:g} fps, {timecode(opened.duration_s, opened.fps)}"
        )
        say(
            f"{counted(int(opened.lost.sum()), 'frame')} lost; head {'recorded' if opened.has_head else 'not recorded'}"
        )
        if (origin := imported(opened)) is not None:
            swapped = livelink.read_as(opened).swapped
            why = origin.rate_reason(opened.fps, Reading(fps))
            say(f"rate: {why}; sides: {in_words(swapped)} ({origin.sides_reason(swapped=swapped)})")
        for notice in opened.notices:
            say(notice)
    show(f"{opened.name}, {counted(len(opened), 'frame')}, {opened.fps:g} fps", rows, as_json=as_json)


def edit(
    take: TakeFile,
    control: Annotated[str, typer.Option(help="Which control, such as lips_vertical or brow_inner.")],
    frames: Annotated[str, typer.Option(help="First frame and the one after the last, such as 40:60.")],
    out: Out,
    set_: Annotated[float | None, typer.Option("--set", help="What it becomes, in mm or degrees.")] = None,
    add: Annotated[float | None, typer.Option("--add", help="What is added, in mm or degrees.")] = None,
    scale: Annotated[float | None, typer.Option("--scale", help="What it is multiplied by.")] = None,
    believability: Annotated[
        float,
        typer.Option(
            help="1: no further than this take or the recordings go. 0: wherever it is pulled.", min=0.0, max=1.0
        ),
    ] = 0.5,
    exact: Annotated[bool, typer.Option("--exact", help="The same as --believability 0.")] = False,
    fps: Fps = None,
    sides: ReadSides = AUTOMATIC,
    write_sides: WrittenSides = SAME,
) -> None:
    """Change one control over a range of frames; the whole face follows."""
    from engine.controls import ALL_CONTROLS, control_index
    from engine.editing import Change, ControlRequest, parse_frames, set_control
    from engine.shortfall import shortfalls

    kinds: dict[Change, float | None] = {"set": set_, "add": add, "scale": scale}
    given = [(kind, amount) for kind, amount in kinds.items() if amount is not None]
    if len(given) != 1:
        raise EditError("Say what becomes of the control.", "Give one of --set, --add or --scale.")
    opened = open_take(take, fps, sides)
    column, (start, stop) = control_index(control), parse_frames(frames, opened)
    believability = 0.0 if exact else believability
    asked = ControlRequest(control, (start, stop), *given[0], believability=believability)
    patch = set_control(opened, asked).settled(opened)
    save_take(patch.apply(opened), out, write_sides)
    reached = patch.reached[start - patch.start : stop - patch.start, column]
    unit = ALL_CONTROLS[column].unit
    say(f"{control} over frames {start}:{stop} is now {reached.min():.2f} to {reached.max():.2f} {unit}")
    for short in shortfalls(patch.weights, patch.asked, believability=believability, granted=patch.granted):
        advice = "; --exact goes there all the same" if short.believed else ""
        say(f"frame {patch.start + short.row}: {short}{advice}")
    say(f"frames outside {patch.start}:{patch.stop} are as they were; wrote {out}")


def register(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(info)
    app.command()(edit)
