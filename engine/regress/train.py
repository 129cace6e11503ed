"""Training the regressor, then the autoencoder on top of it (BSBS19 sections 4.2 and 4.3)."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from engine.controls import CONTROLS, bundled_measurer
from engine.corpus import Piece, split, whole_faces
from engine.models.checkpoint import MODELS, Card, commit, save_card, save_model
from engine.models.windows import windows
from engine.performance.augment import Levers, augment
from engine.performance.corpus import synthetic_performances
from engine.regress.areas import AREAS, Area
from engine.regress.network import AreaNetwork, UNetConfig, from_config
from engine.take import SHAPES, Array

Report = Callable[[str], None]


@dataclass(frozen=True)
class Settings:
    """What a training run depends on; the paper's values unless its place says otherwise."""

    seed: int = 0
    window: int = 64
    overlap: float = 0.75
    batch: int = 128
    rate: float = 1e-3
    decay: float = 0.95
    patience: int = 5
    regressor_epochs: int = 12
    autoencoder_epochs: int = 16
    weight_penalty: float = (
        1e-6  # the paper's beta is 1 on a mean over weights; as a plain sum that drowns the data term
    )
    salt_and_pepper: float = 0.2
    noisy_share: float = 0.5  # an autoencoder that only ever sees noise forgets closures
    distance_share: float = 0.002  # per mm^2, so that 1 mm of lips weighs like 0.045 of a weight
    velocity_share: float = 1.0
    synthetic_minutes: float = 8.0
    levers: Levers = field(default_factory=Levers)


class Distances(torch.nn.Module):
    """The controls of weights, differentiable: `Measurer.measure` in torch, (batch, 52, frames) -> (batch, 8, frames)."""

    rest: Tensor
    basis: Tensor

    def __init__(self) -> None:
        super().__init__()
        rest, basis = bundled_measurer().linear
        self.register_buffer("rest", torch.tensor(rest, dtype=torch.float32))
        self.register_buffer("basis", torch.tensor(basis, dtype=torch.float32))

    def forward(self, weights: Tensor) -> Tensor:
        """Measure; mouthClose counts no further than the jaw is open."""
        jaw, close = SHAPES.index("jawOpen"), SHAPES.index("mouthClose")
        limited = torch.minimum(weights[:, close], weights[:, jaw].clamp(min=0))
        weights = torch.cat([weights[:, :close], limited[:, None], weights[:, close + 1 :]], dim=1)
        vectors = torch.einsum("bst,sk->bkt", weights, self.basis)
        vectors = vectors.reshape(len(weights), len(CONTROLS), 3, -1) + self.rest[None, :, :, None]
        return torch.sqrt(vectors.square().sum(dim=2) + 1e-6)


@dataclass
class _Windows:
    """Training or validation windows of one area, (windows, channels, frames) float32."""

    controls: Tensor
    weights: Tensor


def area_windows(pieces: list[Array], settings: Settings) -> _Windows:
    """Cut pieces into windows with their measured controls."""
    cut = [windows(piece, length=settings.window, overlap=settings.overlap) for piece in pieces]
    weights = np.concatenate(cut)
    flat = bundled_measurer().measure(weights.reshape(-1, len(SHAPES)))
    controls = flat.reshape(*weights.shape[:2], -1)
    return _Windows(*(torch.tensor(x.transpose(0, 2, 1), dtype=torch.float32) for x in (controls, weights)))


def salt_and_pepper(controls: Tensor, low: Tensor, high: Tensor, settings: Settings, rng: torch.Generator) -> Tensor:
    """Throw a share of control values to their lowest or highest, in a share of the windows."""
    noisy = torch.rand(len(controls), 1, 1, generator=rng) < settings.noisy_share
    hit = (torch.rand(controls.shape, generator=rng) < settings.salt_and_pepper) & noisy
    salt = torch.rand(controls.shape, generator=rng) < 0.5
    return torch.where(hit, torch.where(salt, high, low), controls)


def _ridge(network: AreaNetwork, controls: Tensor, weights: Tensor, penalty: float = 1e-3) -> None:
    """Standardise both U-Nets' inputs; start the regressor as ridge regression and the autoencoder as identity."""
    regressor, autoencoder = network.regressor, network.autoencoder
    for unet, curves in ((regressor, controls), (autoencoder, weights)):
        unet.mean.copy_(curves.mean(dim=(0, 2))[None, :, None])
        unet.scale.copy_(curves.std(dim=(0, 2))[None, :, None].clamp(min=0.02))
    x = ((controls - regressor.mean) / regressor.scale).permute(0, 2, 1).reshape(-1, controls.shape[1])
    y = weights.permute(0, 2, 1).reshape(-1, weights.shape[1])
    centre = y.mean(dim=0)
    gram = x.T @ x / len(x) + penalty * torch.eye(x.shape[1])
    with torch.no_grad():
        regressor.linear.weight.copy_(torch.linalg.solve(gram, x.T @ (y - centre) / len(x)).T[:, :, None])
        regressor.linear.bias.copy_(centre)  # type: ignore[union-attr]
        autoencoder.linear.weight.copy_(torch.diag(autoencoder.scale[0, :, 0])[:, :, None])
        autoencoder.linear.bias.copy_(autoencoder.mean[0, :, 0])  # type: ignore[union-attr]


class AreaTrainer:
    """Both stages for one area, resumable after any epoch."""

    def __init__(
        self, area: Area, training: list[Array], validation: list[Array], settings: Settings, out: Path
    ) -> None:
        torch.manual_seed(settings.seed)
        self._area, self._settings = area, settings
        self._train, self._valid = area_windows(training, settings), area_windows(validation, settings)
        self._rng = torch.Generator().manual_seed(settings.seed)
        self._columns = torch.tensor(area.shape_columns)
        self._controls = torch.tensor(area.control_columns)
        self._distances = Distances()
        inputs, outputs = len(self._controls), len(self._columns)
        self.network = AreaNetwork(UNetConfig(inputs, outputs), UNetConfig(outputs, outputs))
        chosen = self._train.controls[:, self._controls]
        _ridge(self.network, chosen, self._train.weights[:, self._columns])
        spread = chosen.permute(1, 0, 2).flatten(1)
        self._low, self._high = (spread.amin(1)[:, None], spread.amax(1)[:, None])
        self._partial = out / f"regress_{area.name}.partial.safetensors"

    def losses(self, made: Tensor, weights: Tensor, controls: Tensor) -> dict[str, Tensor]:
        """Return every term by name: weights, distances (equation 1) and velocity."""
        truth = weights[:, self._columns]
        whole = weights.index_copy(1, self._columns, made)
        distance = (self._distances(whole) - controls)[:, self._controls]
        velocity = made.diff(dim=2) - truth.diff(dim=2)
        return {
            "mse": (made - truth).square().mean(),
            "distance": self._settings.distance_share * distance.square().mean(),
            "velocity": self._settings.velocity_share * velocity.square().mean(),
        }

    def run(self, report: Report) -> dict[str, float]:
        """Train both stages; returns the best validation terms of each."""
        figures = {}
        for stage, epochs in (
            ("regressor", self._settings.regressor_epochs),
            ("autoencoder", self._settings.autoencoder_epochs),
        ):
            best = self._stage(stage, epochs, report)
            figures.update({f"{stage}_{name}": value for name, value in best.items()})
        return figures

    def _stage(self, stage: str, epochs: int, report: Report) -> dict[str, float]:
        part = getattr(self.network, stage)
        part.requires_grad_(True)
        optimizer = torch.optim.Adam(
            part.parameters(), lr=self._settings.rate, weight_decay=self._settings.weight_penalty
        )
        best, best_state, stale = self._validate(stage), _copy(part), 0
        for epoch in range(epochs):
            began = time.monotonic()
            self._epoch(stage, optimizer)
            terms = self._validate(stage)
            better = sum(terms.values()) < sum(best.values())
            if better:
                best, best_state = terms, _copy(part)
            stale = 0 if better else stale + 1
            if stale and stale % self._settings.patience == 0:
                for group in optimizer.param_groups:
                    group["lr"] *= self._settings.decay
            shown = ", ".join(f"{name} {value:.5f}" for name, value in terms.items())
            report(f"{self._area.name} {stage} {epoch + 1}/{epochs}: {shown} ({time.monotonic() - began:.0f} s)")
            self._save_partial(best_state, stage)
        part.load_state_dict(best_state)
        part.requires_grad_(False)
        return best

    def _epoch(self, stage: str, optimizer: torch.optim.Optimizer) -> None:
        self.network.train()
        order = torch.randperm(len(self._train.weights), generator=self._rng)
        for index in torch.split(order, self._settings.batch):
            controls, weights = self._train.controls[index], self._train.weights[index]
            seen = controls[:, self._controls]
            if stage == "autoencoder":
                seen = salt_and_pepper(seen, self._low, self._high, self._settings, self._rng)
            made = self.network(seen, full=stage == "autoencoder")
            loss = torch.stack(list(self.losses(made, weights, controls).values())).sum()
            optimizer.zero_grad()
            loss.backward()  # type: ignore[no-untyped-call]
            optimizer.step()

    def _validate(self, stage: str) -> dict[str, float]:
        """Return the loss terms on the validation windows; the autoencoder also sees them noisy, always alike."""
        self.network.eval()
        rng = torch.Generator().manual_seed(1)
        clean = self._valid.controls[:, self._controls]
        variants = [clean]
        if stage == "autoencoder":
            variants.append(salt_and_pepper(clean, self._low, self._high, self._settings, rng))
        with torch.inference_mode():
            made = [self.network(seen, full=stage == "autoencoder") for seen in variants]
            terms = [self.losses(m, self._valid.weights, self._valid.controls) for m in made]
        return {name: float(torch.stack([term[name] for term in terms]).mean()) for name in terms[0]}

    def _save_partial(self, best_state: dict[str, Tensor], stage: str) -> None:
        state = self.network.state_dict() | {f"{stage}.{name}": value for name, value in best_state.items()}
        save_model(self._partial, state, kind="regress", config=self.network.config() | {"stage": stage})


def _copy(module: torch.nn.Module) -> dict[str, Tensor]:
    return {name: value.clone() for name, value in module.state_dict().items()}


def training_pieces(area: Area, pieces: list[Piece], settings: Settings) -> list[Array]:
    """Return augmented real pieces and synthetic performances for an area."""
    rng = np.random.default_rng(settings.seed)
    chosen = whole_faces(pieces) if area.needs_whole_face else pieces
    real = augment([piece.weights for piece in chosen], settings.levers, rng)
    return real + synthetic_performances(settings.synthetic_minutes, seed=settings.seed)


def train(data: Path, out: Path = MODELS, settings: Settings | None = None, report: Report = print) -> dict[str, Any]:
    """Train all areas on the training split; writes one model and one card each, returns the validation figures."""
    settings = settings or Settings()
    training, validation, _ = split(data)
    figures: dict[str, Any] = {}
    for area in AREAS:
        valid = [p.weights for p in (whole_faces(validation) if area.needs_whole_face else validation)]
        trainer = AreaTrainer(area, training_pieces(area, training, settings), valid, settings, out)
        figures[area.name] = trainer.run(report)
        path = out / f"regress_{area.name}.safetensors"
        save_model(path, trainer.network.state_dict(), kind="regress", config=trainer.network.config())
        save_card(path, _card(training, settings, figures[area.name]))
        trainer._partial.unlink(missing_ok=True)
    return figures


def _card(training: list[Piece], settings: Settings, metrics: dict[str, float]) -> Card:
    seconds: dict[str, float] = {}
    for piece in training:
        seconds[piece.source] = round(seconds.get(piece.source, 0.0) + len(piece.weights) / 30, 1)
    return Card(
        kind="regress",
        data={"recorded_seconds": seconds, "synthetic_minutes": settings.synthetic_minutes},
        split="train; best epoch by the last 15 % of each training take; test takes never seen",
        seed=settings.seed,
        commit=commit(),
        settings=asdict(settings),
        metrics={"validation": metrics},
    )


__all__ = ["AreaTrainer", "Settings", "from_config", "train"]
