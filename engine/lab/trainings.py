"""All networks that can be trained, by the name that `retake train` takes, in the order in which they rest on each other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from engine.errors import EngineError
from engine.lab.evaluate import study
from engine.lab.evaluate.baselines import train as regress_baselines
from engine.lab.evaluate.controls import baselines as controls
from engine.lab.evaluate.inpaint import latent
from engine.lab.reporting import Report
from engine.lab.train.clean import train as clean
from engine.lab.train.inpaint import expected
from engine.lab.train.inpaint import train as inpaint
from engine.lab.train.regress import prior_train
from engine.lab.train.regress import train as regress


@dataclass(frozen=True)
class Training:
    """A network, or several that go together. `train(data, out, report=...)` writes models and cards; it goes on if stopped."""

    name: str
    train: Callable[[Path, Path, Report], object]


TRAININGS: tuple[Training, ...] = (
    Training("regress", lambda data, out, report: regress.train(data, out, report=report)),
    Training("regress_baselines", lambda data, out, report: regress_baselines.train(data, out, report=report)),
    Training("regress_study", lambda data, out, report: study.train(data, out, report=report)),
    Training("clean", lambda data, out, report: clean.train(data, out, report=report)),
    Training("expected", lambda data, out, report: expected.train(data, out, report=report)),
    Training("inpaint", lambda data, out, report: inpaint.train(data, out, report=report)),
    Training("motion", lambda data, out, report: latent.train(data, out, report=report)),
    Training("controls", lambda data, out, report: controls.train(data, out, report=report)),
    Training("prior", lambda data, out, report: prior_train.train(data, out, report=report)),
)


def named(name: str) -> Training:
    """Return the training of a name; raises `EngineError` where there is none."""
    for training in TRAININGS:
        if training.name == name:
            return training
    known = ", ".join(training.name for training in TRAININGS)
    raise EngineError(f"There is no network called {name!r}.", f"Networks are: {known}.")
