"""Training the cleaning network on performances that a simulated tracker has spoilt (BSS20b section 3.2)."""

from __future__ import annotations

import copy
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from engine.clean.network import CleanConfig, CleanNetwork, config_of, run
from engine.clean.network import State as CleanState
from engine.errors import EngineError
from engine.lab.corpus import Piece, recorded_seconds, split
from engine.lab.reporting import Report
from engine.lab.train import loop
from engine.lab.train.clean.batches import Batch, Settings, make_batch, training_pieces
from engine.lab.train.clean.tuning import train_rivals
from engine.lab.train.loop import Parts, Schedule, State, identity
from engine.models.checkpoint import MODELS, Card, commit, save_card, save_model
from engine.models.distances import Distances, six_distances
from engine.take import Array

MM_PER_CM = 10.0  # distances count in cm, so that they weigh like weights


def losses(result: Tensor, batch: Batch, before: Tensor, distances: Distances, settings: Settings) -> dict[str, Tensor]:
    """Return every term by name: weights, their derivative, distances to the truth and to the tracker's.

    `made` is (streams, frames, 52) and `before` the difference from the truth on the frame before, (streams, 1, 52).
    """
    share = batch.present + settings.lost_share * (1 - batch.present)
    error = (result - batch.truth) * share.sqrt()
    slope = torch.diff(error, dim=1, prepend=before) / batch.step_s
    truth, tracked, estimate = (distances(weights) for weights in (batch.truth, batch.seen, result))
    pull = ((tracked - estimate).abs() * batch.present).mean()
    return {
        "mse": error.square().mean(),
        "derivative": settings.derivative_share * slope.square().mean(),
        "distance": settings.distance_share * ((truth - estimate).abs() * share).mean(),
        "input_distance": settings.distance_share * settings.input_distance_share * pull,
    }


class Trainer:
    """Streams of several chunks, one step of Adam a chunk; a unit of the loop is an epoch of such streams."""

    def __init__(self, training: list[Array], validation: list[Array], settings: Settings) -> None:
        torch.manual_seed(settings.seed)
        self._settings, self._training = settings, training
        self._rng = np.random.default_rng(settings.seed)
        self._distances = six_distances(unit_mm=MM_PER_CM)
        self._valid = make_batch(validation, settings, np.random.default_rng(1))
        self.network = CleanNetwork(CleanConfig())
        self._optimizer = torch.optim.Adam(self.network.parameters(), lr=settings.rate)
        self._start_as_ridge()
        self._best, self._best_terms = copy.deepcopy(self.network), self.validate()

    def _start_as_ridge(self) -> None:
        """Begin the restoring map as the ridge regression of what the tracker took away on what it shows."""
        batch = make_batch(self._training, self._settings, self._rng)
        kept = batch.present[..., 0] > 0
        seen, missing = batch.seen[kept], (batch.truth - batch.seen)[kept]
        centre, gap = seen.mean(dim=0), missing.mean(dim=0)
        x = seen - centre
        gram = x.T @ x / len(x) + self._settings.ridge * torch.eye(x.shape[1])
        slope = torch.linalg.solve(gram, x.T @ (missing - gap) / len(x)).T
        with torch.no_grad():
            self.network.restore.weight.copy_(slope)
            self.network.restore.bias.copy_(gap - slope @ centre)

    def advance(self, unit: int) -> dict[str, float]:
        """Train one epoch and keep the network where it is the best yet; returns its validation terms."""
        settings, share = self._settings, unit / self._settings.epochs
        for group in self._optimizer.param_groups:
            group["lr"] = settings.rate * (0.5 + 0.5 * np.cos(np.pi * share)) * min(1.0, 0.3 + unit / 4)
        chunk = settings.first_chunk if share < 2 / 3 else settings.chunk
        learnt = [self._learn(make_batch(self._training, settings, self._rng), chunk) for _ in range(settings.batches)]
        terms = self.validate() | {"training_mse": float(np.mean(learnt))}
        if terms["mse"] < self._best_terms["mse"]:
            self._best_terms = terms
            self._best.load_state_dict(self.network.state_dict())
        return terms

    def best(self) -> tuple[CleanNetwork, dict[str, float]]:
        """Return the network as it was in its best epoch, and its validation terms."""
        return self._best, self._best_terms

    def _learn(self, batch: Batch, length: int) -> float:
        """Take one step of Adam for each chunk; returns the mean squared error on the way."""
        mse = 0.0
        state = self.network.start(batch.seen[:, 0])
        before = torch.zeros_like(batch.truth[:, :1])
        for chunk in _chunks(batch, length):
            result, state = self._forward(chunk, state)
            terms = losses(result, chunk, before, self._distances, self._settings)
            loss = torch.stack(list(terms.values())).sum()
            self._optimizer.zero_grad()
            loss.backward()  # type: ignore[no-untyped-call]
            torch.nn.utils.clip_grad_norm_(self.network.parameters(), 0.5)
            self._optimizer.step()
            state, before = state.detached(), (result - chunk.truth)[:, -1:].detach()
            mse += float(terms["mse"].detach()) * length / batch.truth.shape[1]
        return mse

    def _forward(self, chunk: Batch, state: CleanState) -> tuple[Tensor, CleanState]:
        return run(self.network, chunk.seen, chunk.present, chunk.step_s, state, dropout=self._settings.dropout)

    def validate(self) -> dict[str, float]:
        """Return the loss terms on validation takes, always spoilt alike, and the mean squared error of the input."""
        batch = self._valid
        with torch.inference_mode():
            result, _ = run(self.network, batch.seen, batch.present, batch.step_s, self.network.start(batch.seen[:, 0]))
            before = torch.zeros_like(batch.truth[:, :1])
            terms = losses(result, batch, before, self._distances, self._settings)
            terms["mse"] = (result - batch.truth).square().mean()
            terms["raw_mse"] = (batch.seen - batch.truth).square().mean()
            kept = batch.present
            for name, curves in (("seen_mse", result), ("raw_seen_mse", batch.seen)):
                terms[name] = ((curves - batch.truth).square() * kept).sum() / kept.sum() / curves.shape[2]
        return {name: float(value) for name, value in terms.items()}

    def _parts(self) -> Parts:
        modules = {"network": self.network, "best": self._best}
        return Parts(modules, {"adam": self._optimizer}, {"batches": self._rng})

    def state(self) -> State:
        """Return the network, the best yet with its terms, Adam's averages and where the random numbers stand."""
        return State(self._parts().tensors(), {"best": self._best_terms})

    def restore(self, state: State) -> None:
        """Take over such a state."""
        self._parts().restore(state.tensors)
        self._best_terms = dict(state.notes["best"])


def _chunks(batch: Batch, length: int) -> list[Batch]:
    cut = [torch.split(part, length, dim=1) for part in batch]
    return [Batch(*parts) for parts in zip(*cut, strict=True)]


def train(data: Path, out: Path = MODELS, settings: Settings | None = None, report: Report = print) -> dict[str, Any]:
    """Train on the training split; writes the model and its card, returns the validation figures.

    Stopped by Ctrl+C, it goes on from the last epoch when run again. The methods that cleaning is compared with are
    tuned at the end, where scikit-learn is installed.
    """
    settings = settings or Settings()
    torch.set_num_threads(1)  # the steps are small: a second thread waits more than it works
    training, validation, _ = split(data)
    pieces, partial = training_pieces(training, settings), out / "clean.partial.safetensors"
    trainer = Trainer(pieces, [piece.weights for piece in validation], settings)
    schedule = Schedule(
        settings.epochs, partial, identity(settings, pieces), label=lambda done: f"clean {done}/{settings.epochs}"
    )
    loop.train(trainer, schedule, report)
    network, figures = trainer.best()
    path = out / "clean.safetensors"
    save_model(path, network.state_dict(), kind="clean", config=config_of(network))
    save_card(path, _card(training, settings, figures))
    partial.unlink(missing_ok=True)
    _train_rivals(data, out, report)
    return figures


def _train_rivals(data: Path, out: Path, report: Report) -> None:
    try:
        train_rivals(data, out, report=report)
    except EngineError as missing:
        report(f"The rivals stay as they are. {missing}")


def _card(training: list[Piece], settings: Settings, metrics: dict[str, float]) -> Card:
    return Card(
        kind="clean",
        data={"recorded_seconds": recorded_seconds(training), "synthetic_minutes": settings.synthetic_minutes},
        split="train; best state by the last 15 % of each training take; test takes never seen",
        seed=settings.seed,
        commit=commit(),
        settings=asdict(settings),
        metrics={"validation": metrics},
        notes="Trained against simulated tracker faults; those of another tracker may differ.",
    )
