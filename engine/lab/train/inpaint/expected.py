"""Training the face to expect: every window of the material with any few of its controls, or all, to its weights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch.nn.functional import mse_loss

from engine.controls import CONTROL_INDEX, CONTROLS, FEW, bundled_measurer
from engine.inpaint.expected import TUNING, Expected
from engine.lab.corpus import Piece, split, whole_faces
from engine.lab.reporting import Report
from engine.lab.train import loop
from engine.lab.train.inpaint.material import Help, Performance, draw, performances
from engine.lab.train.loop import Parts, Schedule, State, identity
from engine.models.checkpoint import MODELS, Card, commit, save_card, save_model
from engine.models.threads import one_thread
from engine.take import SHAPES, Array, Mask

PARTIAL = "expected.partial.safetensors"


@dataclass(frozen=True)
class Settings:
    """What a training run depends on; chosen on validation takes."""

    seed: int = 0
    members: int = TUNING.members
    steps: int = 1500  # of each member
    frames: int = 64
    batch: int = 64
    rate: float = 1e-3
    everything: float = 0.3  # share of windows with all controls
    few: float = 0.2  # share of windows with those of `FEW`
    broken: float = 0.25  # share of windows in which controls are given only part of the time
    offset_mm: float = 0.5  # constant over a window: people differ where their curves do not
    help: Help = field(default_factory=Help)


def given_controls(size: int, frames: int, settings: Settings, rng: np.random.Generator) -> Mask:
    """Return which controls are shown when, (size, frames, 8): all, the few, or any, some of them for a while only."""
    shown = rng.random((size, len(CONTROLS))) < rng.uniform(0.1, 0.9, (size, 1))
    shown[np.arange(size), rng.integers(len(CONTROLS), size=size)] = True
    kind = rng.random(size)
    shown[kind < settings.everything] = True
    shown[kind > 1 - settings.few] = np.isin(list(CONTROL_INDEX), FEW)
    start, length = rng.integers(frames, size=(2, size, 1))
    at = np.arange(frames)
    whole = rng.random((size, 1)) > settings.broken
    return np.asarray(shown[:, None, :] & (whole | (at < start) | (at >= start + length))[..., None])


class Trainer:
    """One member after another; a unit of the loop is a step of one of them."""

    def __init__(self, material: Sequence[Performance], settings: Settings) -> None:
        self._material, self._settings = material, settings
        self._members: list[Expected] = []
        self._begin(0)

    def _begin(self, member: int) -> None:
        settings = self._settings
        torch.manual_seed(settings.seed + member)
        self._rng = np.random.default_rng([settings.seed, member])
        self._network = _standing(self._material)
        self._optimizer = torch.optim.Adam(self._network.parameters(), lr=settings.rate)
        self._pace = torch.optim.lr_scheduler.CosineAnnealingLR(self._optimizer, settings.steps, settings.rate / 20)
        self._network.train()

    def advance(self, unit: int) -> dict[str, float]:
        """Take one step of Adam on a batch drawn for it; returns its mean squared error."""
        settings, (member, step) = self._settings, divmod(unit, self._settings.steps)
        if member and step == 0:
            self._members.append(self._network.eval())
            self._begin(member)
        weights = np.stack([draw(self._material, settings.frames, self._rng).weights for _ in range(settings.batch)])
        loss = mse_loss(
            self._network(torch.tensor(_shown(weights, settings, self._rng), dtype=torch.float32)),
            torch.tensor(weights, dtype=torch.float32),
        )
        self._optimizer.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        self._optimizer.step()
        self._pace.step()
        return {"mse": float(loss.detach())}

    def trained(self) -> Expected:
        """Return one network of all members."""
        return joined([*self._members, self._network.eval()])

    def _parts(self) -> Parts:
        done = {f"member_{index}": member for index, member in enumerate(self._members)}
        return Parts({"network": self._network, **done}, {"adam": self._optimizer}, {"batches": self._rng})

    def state(self) -> State:
        """Return the members that are done, the one under way, and what its next step depends on."""
        rate = [group["lr"] for group in self._optimizer.param_groups]
        return State(self._parts().tensors(), {"done": len(self._members), "rate": rate, "pace": self._pace.last_epoch})

    def restore(self, state: State) -> None:
        """Take over such a state."""
        self._members = [_standing(self._material).eval() for _ in range(int(state.notes["done"]))]
        self._begin(len(self._members))
        self._parts().restore(state.tensors)
        for group, rate in zip(self._optimizer.param_groups, state.notes["rate"], strict=True):
            group["lr"] = rate
        self._pace.last_epoch = int(state.notes["pace"])


def _standing(material: Sequence[Performance]) -> Expected:
    """Return an untrained network of one member that knows mean and spread of the material."""
    network = Expected(members=1)
    faces = np.concatenate([each.weights for each in material])
    measured = bundled_measurer().measure(faces)
    for name, value in (
        ("rest", measured.mean(axis=0)),
        ("spread", measured.std(axis=0)),
        ("mean", faces.mean(axis=0)),
        ("scale", np.maximum(faces.std(axis=0), 0.02)),
    ):
        getattr(network, name).copy_(torch.tensor(value))
    return network


def _shown(weights: Array, settings: Settings, rng: np.random.Generator) -> Array:
    size, frames = weights.shape[:2]
    measured = bundled_measurer().measure(weights.reshape(-1, len(SHAPES))).reshape(size, frames, -1)
    off = settings.offset_mm * rng.standard_normal((size, 1, len(CONTROLS)))
    return np.where(given_controls(size, frames, settings, rng), measured + off, np.nan)


def joined(networks: Sequence[Expected]) -> Expected:
    """Return one network of all members of some that were trained on the same material."""
    whole = Expected(members=0)
    whole.load_state_dict({name: value for name, value in networks[0].state_dict().items() if "." not in name})
    for network in networks:
        whole.members.extend(network.members)
    return whole.eval()


def train(
    data: Path, out: Path = MODELS, settings: Settings | None = None, report: Report = print
) -> dict[str, dict[str, float]]:
    """Train and write the networks with their card; returns validation errors. Goes on from the last hundred steps."""
    settings = settings or Settings()
    training, validation, _ = split(data)
    material = performances(training, settings.help, np.random.default_rng(settings.seed))
    with one_thread():
        network = fitted(material, settings, out / PARTIAL, report)
    figures = validation_errors(network, validation)
    report(f"expected: validation mse {figures}")
    save_model(
        out / "expected.safetensors",
        network.state_dict(),
        kind="expected",
        config={"members": len(network.members)},
    )
    save_card(out / "expected.safetensors", _card(training, settings, figures))
    (out / PARTIAL).unlink(missing_ok=True)
    return figures


def fitted(material: Sequence[Performance], settings: Settings, path: Path, report: Report) -> Expected:
    """Return the networks trained on the material; `path` is their checkpoint."""
    trainer = Trainer(material, settings)
    schedule = Schedule(
        settings.members * settings.steps,
        path,
        identity(settings, (each.weights for each in material)),
        label=lambda done: f"expected {done}/{settings.members * settings.steps}",
        every=100,
    )
    loop.train(trainer, schedule, report)
    return trainer.trained()


def validation_errors(network: Expected, pieces: Sequence[Piece]) -> dict[str, dict[str, float]]:
    """Return mean squared errors on whole faces, by which controls are given."""
    errors: dict[str, dict[str, float]] = {}
    for name, chosen in (("eight", tuple(CONTROL_INDEX)), ("three", FEW), ("lips_vertical", FEW[:1])):
        off = []
        for piece in whole_faces(pieces):
            measured = bundled_measurer().measure(piece.weights)
            result = network.pose(np.where(np.isin(list(CONTROL_INDEX), chosen), measured, np.nan))
            off.append((result - piece.weights) ** 2)
        errors[name] = {"mse": round(float(np.concatenate(off).mean()), 5)}
    return errors


def _card(training: Sequence[Piece], settings: Settings, metrics: dict[str, Any]) -> Card:
    return Card(
        kind="expected",
        data={"recordings": sorted({piece.source for piece in training})},
        split="train; figures on the last 15 % of each training take; test takes never seen",
        seed=settings.seed,
        commit=commit(),
        settings=asdict(settings),
        metrics={"validation": metrics},
        notes="Lies under fills steered by control curves: `retake train inpaint` reads it, so train it first.",
    )
