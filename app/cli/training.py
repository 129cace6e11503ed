"""`retake train` and `retake build`: making the networks and the bundled assets anew."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.printing import say
from engine.errors import EngineError

NETWORKS = (
    "regress",
    "regress_baselines",
    "regress_study",
    "clean",
    "expected",
    "inpaint",
    "motion",
    "controls",
    "prior",
)
ELSEWHERE = {  # the others are engine.NAME.train
    "regress_baselines": "engine.lab.evaluate.baselines.train",
    "regress_study": "engine.lab.evaluate.study",
    "prior": "engine.lab.train.regress.prior_train",
    "expected": "engine.lab.train.inpaint.expected",
    "motion": "engine.lab.evaluate.latent",
    "controls": "engine.lab.evaluate.regressors",
}
ASSETS = ("demo", "head")


def train(
    name: Annotated[str, typer.Argument(help=f"Which network: {', '.join(NETWORKS)}.")],
    data: Annotated[Path | None, typer.Option(help="A folder of takes to train on; RETAKE_DATA otherwise.")] = None,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="Where models and cards are written.")] = None,
) -> None:
    """Train a network; stop it at any time and run it again to go on."""
    import importlib

    from engine.lab.corpus import data_folder
    from engine.models.checkpoint import MODELS

    if name not in NETWORKS:
        raise EngineError(f"There is no network called {name!r}.", f"Networks are: {', '.join(NETWORKS)}.")
    trainer = importlib.import_module(ELSEWHERE.get(name, f"engine.{name}.train"))
    trainer.train(data or data_folder(), out or MODELS, report=say)


def build(name: Annotated[str, typer.Argument(help=f"Which asset: {', '.join(ASSETS)}.")]) -> None:
    """Rebuild a bundled asset: the head, or the demo take."""
    if name == "demo":
        from engine.lab.performer import demo

        demo.build()
    elif name == "head":
        from engine.lab.modelling import head

        head.build()
    else:
        raise EngineError(f"There is no asset called {name!r}.", f"Assets are: {', '.join(ASSETS)}.")


def register(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(train)
    app.command()(build)
