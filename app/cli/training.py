"""`retake train` and `retake build`: train the networks and build the bundled assets."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.cli.listing import listing
from app.printing import say
from engine.errors import EngineError

ASSETS = ("demo", "head", "second-head")


def train(
    name: Annotated[str, typer.Argument(help="Which network.")],
    data: Annotated[Path | None, typer.Option(help="A folder of takes to train on; RETAKE_DATA otherwise.")] = None,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="Where models and cards are written.")] = None,
) -> None:
    """Train a network; stop it at any time and run it again to go on."""
    from engine.lab.corpus import data_folder
    from engine.lab.trainings import named
    from engine.models.checkpoint import MODELS

    named(name).train(data or data_folder(), out or MODELS, say)


def build(name: Annotated[str, typer.Argument(help=f"Which asset: {', '.join(ASSETS)}.")]) -> None:
    """Rebuild a bundled asset: a head, or the demo take."""
    if name == "demo":
        from engine.lab.performer import demo

        demo.build()
    elif name == "head":
        from engine.lab.modelling import head

        head.build()
    elif name == "second-head":
        from engine.lab.sculpting import head as second

        second.build()
    else:
        raise EngineError(f"There is no asset called {name!r}.", f"Assets are: {', '.join(ASSETS)}.")


def _names() -> list[str]:
    from engine.lab.trainings import TRAININGS

    return [training.name for training in TRAININGS]


def register(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command(cls=listing(_names, "Which network"))(train)
    app.command()(build)
