"""One loop trains every network: unit after unit, with a report and a checkpoint now and then, from which it goes on.

A unit is a step or an epoch, as the job has it. A run that was stopped at any moment ends as one that was not.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import torch
from torch import Tensor

from engine.errors import AssetError
from engine.lab.reporting import Report
from engine.models.checkpoint import load_model, save_model
from engine.take import Array

KIND = "training"


@dataclass(frozen=True)
class State:
    """All that the units to come depend on: tensors by name, and plain numbers and names as JSON holds them."""

    tensors: Mapping[str, Tensor]
    notes: Mapping[str, Any] = field(default_factory=dict)


class Job(Protocol):
    """What is trained. After `restore(state())` in another process, `advance` does what it would have done."""

    def advance(self, unit: int) -> Mapping[str, float]:
        """Train one unit, counted from 0; returns its loss terms by name."""

    def state(self) -> State:
        """Return what the next unit depends on."""

    def restore(self, state: State) -> None:
        """Take over a state of a job with the same settings and data."""


@dataclass(frozen=True)
class Schedule:
    """How long a job is trained, and where its checkpoints lie.

    Attributes
    ----------
    units : how many there are
    every : units from one checkpoint and report to the next
    path : the checkpoint
    run : settings and data, see `identity`; a checkpoint of another run is left alone and the job begins anew
    shared, shared_units : the checkpoint of the first units, which several jobs have in common
    label : what a report calls a unit that is done, by its number from 1
    """

    units: int
    path: Path
    run: Mapping[str, Any]
    label: Callable[[int], str]
    every: int = 1
    shared: Path | None = None
    shared_units: int = 0


def train(job: Job, schedule: Schedule, report: Report) -> float:
    """Train a job to its last unit from wherever an earlier run stopped; returns the seconds that this run took."""
    done = _resumed(job, schedule, report)
    began, terms = time.monotonic(), list[Mapping[str, float]]()
    while done < schedule.units:
        terms.append(job.advance(done))
        done += 1
        if done % schedule.every == 0 or done == schedule.units:
            _save(job, schedule, done)
            shown = ", ".join(f"{name} {value:.5f}" for name, value in _means(terms).items())
            report(f"{schedule.label(done)}: {shown} ({time.monotonic() - began:.0f} s)")
            terms = []
    return time.monotonic() - began


def identity(settings: Any, data: Iterable[Array]) -> dict[str, Any]:
    """Return what tells a run from others: its settings, a dataclass, and a digest of the arrays that it learns from."""
    digest = hashlib.sha256()
    for array in data:
        digest.update(np.ascontiguousarray(array).tobytes())
    plain: dict[str, Any] = json.loads(json.dumps(asdict(settings)))
    return {"settings": plain, "data": digest.hexdigest()}


def _means(terms: list[Mapping[str, float]]) -> dict[str, float]:
    return {name: float(np.mean([one[name] for one in terms if name in one])) for name in terms[-1]}


def _save(job: Job, schedule: Schedule, done: int) -> None:
    state = job.state()
    path = schedule.shared if schedule.shared is not None and done <= schedule.shared_units else schedule.path
    config = {"done": done, "run": schedule.run, "notes": state.notes}
    save_model(path, state.tensors, kind=KIND, config=config)


def _resumed(job: Job, schedule: Schedule, report: Report) -> int:
    """Return how many units are done by the furthest checkpoint of this run, whose state the job then has."""
    for path in (schedule.path, schedule.shared):
        if path is None or not path.exists():
            continue
        try:
            tensors, config = load_model(path, kind=KIND)
        except AssetError as error:
            report(f"{error.sentence} The training begins anew.")
            continue
        if config["run"] == schedule.run:
            job.restore(State(tensors, config["notes"]))
            report(f"going on after {schedule.label(int(config['done']))}")
            return int(config["done"])
    return 0


@dataclass(frozen=True, eq=False)
class Parts:
    """Modules, optimizers and random numbers as tensors to write and to read back, each under its name."""

    modules: Mapping[str, torch.nn.Module]
    optimizers: Mapping[str, torch.optim.Optimizer] = field(default_factory=dict)
    randoms: Mapping[str, np.random.Generator] = field(default_factory=dict)

    def tensors(self) -> dict[str, Tensor]:
        """Return copies of all."""
        found = {"torch": torch.get_rng_state()}
        for name, module in self.modules.items():
            found |= {f"{name}/{key}": value.clone() for key, value in module.state_dict().items()}
        for name, optimizer in self.optimizers.items():
            for index, state in optimizer.state_dict()["state"].items():
                found |= {f"{name}/{index}/{key}": torch.as_tensor(value).clone() for key, value in state.items()}
        for name, random in self.randoms.items():
            found[name] = torch.tensor(list(json.dumps(random.bit_generator.state).encode()), dtype=torch.uint8)
        return found

    def restore(self, tensors: Mapping[str, Tensor]) -> None:
        """Read all back; rates of optimizers stay as they are."""
        torch.set_rng_state(tensors["torch"])
        for name, module in self.modules.items():
            module.load_state_dict(_below(tensors, name))
        for name, optimizer in self.optimizers.items():
            state: dict[int, dict[str, Tensor]] = {}
            for key, value in _below(tensors, name).items():
                index, part = key.split("/")
                state.setdefault(int(index), {})[part] = value
            optimizer.load_state_dict({"state": state, "param_groups": optimizer.state_dict()["param_groups"]})
        for name, random in self.randoms.items():
            random.bit_generator.state = json.loads(bytes(tensors[name].tolist()))


def _below(tensors: Mapping[str, Tensor], name: str) -> dict[str, Tensor]:
    prefix = f"{name}/"
    return {key.removeprefix(prefix): value for key, value in tensors.items() if key.startswith(prefix)}
