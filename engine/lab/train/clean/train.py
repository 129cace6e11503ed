"""Training the cleaning network on performances that a simulated tracker has spoilt (BSS20b section 3.2)."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from engine.clean.network import CleanConfig, CleanNetwork, State, config_of, run
from engine.errors import EngineError
from engine.lab.corpus import Piece, recorded_seconds, split
from engine.lab.train.clean.batches import Batch, Settings, make_batch, training_pieces
from engine.lab.train.clean.tuning import train_rivals
from engine.models.checkpoint import MODELS, Card, commit, load_model, save_card, save_model
from engine.models.distances import Distances, six_distances
from engine.take import Array

Report = Callable[[str], None]
MM_PER_CM = 10.0  # distances count in cm, so that they weigh like weights


def losses(made: Tensor, batch: Batch, before: Tensor, distances: Distances, settings: Settings) -> dict[str, Tensor]:
    """Return every term by name: weights, their derivative, distances to the truth and to the tracker's.

    `made` is (streams, frames, 52) and `before` the difference from the truth on the frame before, (streams, 1, 52).
    """
    share = batch.present + settings.lost_share * (1 - batch.present)
    error = (made - batch.truth) * share.sqrt()
    slope = torch.diff(error, dim=1, prepend=before) / batch.step_s
    truth, tracked, estimate = (distances(weights) for weights in (batch.truth, batch.seen, made))
    pull = ((tracked - estimate).abs() * batch.present).mean()
    return {
        "mse": error.square().mean(),
        "derivative": settings.derivative_share * slope.square().mean(),
        "distance": settings.distance_share * ((truth - estimate).abs() * share).mean(),
        "input_distance": settings.distance_share * settings.input_distance_share * pull,
    }


class Trainer:
    """The training loop: streams of several chunks, one step of Adam a chunk."""

    def __init__(self, training: list[Array], validation: list[Array], settings: Settings, partial: Path) -> None:
        torch.manual_seed(settings.seed)
        self._settings, self._training, self._partial = settings, training, partial
        self._rng = np.random.default_rng(settings.seed)
        self._distances = six_distances(unit_mm=MM_PER_CM)
        self._valid = make_batch(validation, settings, np.random.default_rng(1))
        self.network = CleanNetwork(CleanConfig())
        self._optimizer = torch.optim.Adam(self.network.parameters(), lr=settings.rate)
        self._start_as_ridge()
        self._epoch = 0
        self._resume()

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

    def run(self, report: Report) -> dict[str, float]:
        """Train for the settings' epochs; returns validation terms of the best state, which the network then holds."""
        settings, began = self._settings, time.monotonic()
        best, best_state = self.validate(), self._copy()
        for epoch in range(self._epoch, settings.epochs):
            share = epoch / settings.epochs
            for group in self._optimizer.param_groups:
                group["lr"] = settings.rate * (0.5 + 0.5 * np.cos(np.pi * share)) * min(1.0, 0.3 + epoch / 4)
            chunk = settings.first_chunk if share < 2 / 3 else settings.chunk
            learnt = [
                self._learn(make_batch(self._training, settings, self._rng), chunk) for _ in range(settings.batches)
            ]
            terms = self.validate() | {"training_mse": float(np.mean(learnt))}
            if terms["mse"] < best["mse"]:
                best, best_state = terms, self._copy()
            self._save(epoch + 1)
            shown = ", ".join(f"{name} {value:.6f}" for name, value in terms.items())
            report(f"clean {epoch + 1}/{settings.epochs}: {shown} ({time.monotonic() - began:.0f} s)")
        self.network.load_state_dict(best_state)
        return best

    def _learn(self, batch: Batch, length: int) -> float:
        """Take one step of Adam for each chunk; returns the mean squared error on the way."""
        mse = 0.0
        state = self.network.start(batch.seen[:, 0])
        before = torch.zeros_like(batch.truth[:, :1])
        for chunk in _chunks(batch, length):
            made, state = self._forward(chunk, state)
            terms = losses(made, chunk, before, self._distances, self._settings)
            loss = torch.stack(list(terms.values())).sum()
            self._optimizer.zero_grad()
            loss.backward()  # type: ignore[no-untyped-call]
            torch.nn.utils.clip_grad_norm_(self.network.parameters(), 0.5)
            self._optimizer.step()
            state, before = state.detached(), (made - chunk.truth)[:, -1:].detach()
            mse += float(terms["mse"].detach()) * length / batch.truth.shape[1]
        return mse

    def _forward(self, chunk: Batch, state: State) -> tuple[Tensor, State]:
        return run(self.network, chunk.seen, chunk.present, chunk.step_s, state, dropout=self._settings.dropout)

    def validate(self) -> dict[str, float]:
        """Return the loss terms on validation takes, always spoilt alike, and the mean squared error of the input."""
        batch = self._valid
        with torch.inference_mode():
            made, _ = run(self.network, batch.seen, batch.present, batch.step_s, self.network.start(batch.seen[:, 0]))
            before = torch.zeros_like(batch.truth[:, :1])
            terms = losses(made, batch, before, self._distances, self._settings)
            terms["mse"] = (made - batch.truth).square().mean()
            terms["raw_mse"] = (batch.seen - batch.truth).square().mean()
            kept = batch.present
            for name, curves in (("seen_mse", made), ("raw_seen_mse", batch.seen)):
                terms[name] = ((curves - batch.truth).square() * kept).sum() / kept.sum() / curves.shape[2]
        return {name: float(value) for name, value in terms.items()}

    def _copy(self) -> dict[str, Tensor]:
        return {name: value.clone() for name, value in self.network.state_dict().items()}

    def _save(self, epoch: int) -> None:
        save_model(self._partial, self._copy(), kind="clean", config=config_of(self.network) | {"epoch": epoch})

    def _resume(self) -> None:
        """Go on where a run that was stopped left off; Adam's averages are regained within an epoch."""
        if self._partial.exists():
            tensors, config = load_model(self._partial, kind="clean")
            self.network.load_state_dict(tensors)
            self._epoch = int(config["epoch"])


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
    partial = out / "clean.partial.safetensors"
    trainer = Trainer(training_pieces(training, settings), [piece.weights for piece in validation], settings, partial)
    figures = trainer.run(report)
    path = out / "clean.safetensors"
    save_model(path, trainer.network.state_dict(), kind="clean", config=config_of(trainer.network))
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
