"""`retake blind`: a sheet of short movies, half recorded and half filled, to try on people; and its scoring."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.printing import say
from engine.words import counted


def make(
    out: Annotated[Path, typer.Option("-o", "--out", help="The folder for the movies.", show_default=False)],
    key: Annotated[Path, typer.Option(help="Where the key goes: out of sight of who watches.", show_default=False)],
    data: Annotated[Path | None, typer.Option(help="A folder of takes instead of the test split.")] = None,
    count: Annotated[int, typer.Option(help="How many movies.", min=2, max=400)] = 40,
    seed: Annotated[int, typer.Option(help="Another seed, another sheet.")] = 0,
    size: Annotated[int, typer.Option(help="Height in pixels.", min=64, max=1080)] = 360,
) -> None:
    """Write the movies, an empty answer table beside them, and the key elsewhere."""
    from app.preview import movie
    from engine.formats.base.atomic import write_bytes
    from engine.lab.corpus import pieces_to_measure
    from engine.lab.evaluate.inpaint.blind import exhibits, key_of

    sheet = exhibits(pieces_to_measure(data), seed=seed, count=count)
    out.mkdir(parents=True, exist_ok=True)
    for row in sheet:
        movie.write_movie([row.take], out / f"{row.name}.mp4", height=size)
    write_bytes(out / "answers.csv", ["".join(["movie,answer\n", *(f"{row.name},\n" for row in sheet)]).encode()])
    write_bytes(key, [key_of(sheet).encode()])
    say(f"wrote {counted(len(sheet), 'movie')} and answers.csv to {out}; the key is {key}")


def score(
    answers: Annotated[Path, typer.Argument(help="A filled-in answers.csv: recorded or filled behind each movie.")],
    key: Annotated[Path, typer.Option(help="The key of the sheet.", show_default=False)],
) -> None:
    """Say how often recorded and filled motion was taken for recorded (BSS20: 0.54 and 0.51)."""
    from engine.lab.evaluate.inpaint.blind import score as scored

    for name, value in scored(answers, key).items():
        say(f"{name}: {value:g}")


def register(app: typer.Typer) -> None:
    """Add the commands of this module."""
    family = typer.Typer(help="Try people on recorded and filled motion.", no_args_is_help=True)
    family.command()(make)
    family.command()(score)
    app.add_typer(family, name="blind")
