"""Regressors that make a whole face of three control curves, for BSS20 table 4: HSK16 and BSBS19.

Trained on the very windows that the filling network sees. With all eight controls the table uses `baselines`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn.functional import mse_loss

from engine.controls import CONTROL_INDEX, FEW, bundled_measurer
from engine.lab.corpus import split
from engine.lab.reporting import Report
from engine.lab.train.inpaint.material import Help, Performance, draw, performances
from engine.models.checkpoint import MODELS, Card, commit, load_model, save_card, save_model
from engine.models.unet import ALIGNMENT, BatchNormUNet
from engine.take import SHAPES, Array

FRAMES, BATCH, STEPS, SEED = 64, 64, 1500, 0


class HSK16(nn.Module):
    """Holden, Saito and Komura 2016: a motion autoencoder of one layer each way, and two layers from controls to it."""

    def __init__(self, inputs: int, width: int = 15, units: int = 128) -> None:
        super().__init__()
        pad, shapes = width // 2, len(SHAPES)
        self.encode = nn.Sequential(
            nn.Dropout(0.1), nn.Conv1d(shapes, units, width, padding=pad), nn.ReLU(), nn.MaxPool1d(2)
        )
        self.decode = nn.Sequential(nn.Upsample(scale_factor=2), nn.Conv1d(units, shapes, width, padding=pad))
        self.regress = nn.Sequential(
            *(nn.Conv1d(inputs, 64, width, padding=pad), nn.ReLU()),
            *(nn.Conv1d(64, units, width, padding=pad), nn.ReLU(), nn.MaxPool1d(2)),
        )

    def forward(self, controls: Tensor) -> Tensor:
        """Return weights, (batch, 52, frames), of standardised controls, (batch, controls, frames)."""
        result: Tensor = self.decode(self.regress(controls))
        return result

    def loss(self, controls: Tensor, weights: Tensor, stage: int) -> Tensor:
        """First the autoencoder learns to hold motion, then, held fast, controls are regressed to it."""
        if stage == 0:
            return mse_loss(self.decode(self.encode(weights)), weights)
        return mse_loss(self(controls), weights)

    def trained(self, stage: int) -> list[nn.Module]:
        """Return the parts that learn in a stage."""
        return [self.encode, self.decode] if stage == 0 else [self.regress]


class BSBS19(nn.Module):
    """A regressor, then a denoising autoencoder on top of it, each a U-Net."""

    def __init__(self, inputs: int) -> None:
        super().__init__()
        self.regressor, self.autoencoder = BatchNormUNet(inputs, len(SHAPES)), BatchNormUNet(len(SHAPES), len(SHAPES))

    def forward(self, controls: Tensor) -> Tensor:
        """Return weights, (batch, 52, frames), of standardised controls, (batch, controls, frames)."""
        result: Tensor = self.autoencoder(self.regressor(controls))
        return result

    def loss(self, controls: Tensor, weights: Tensor, stage: int) -> Tensor:
        """Regression first; then both, under salt and pepper on a fifth of the controls in half the windows."""
        if stage == 0:
            return mse_loss(self.regressor(controls), weights)
        hit = (torch.rand(controls.shape) < 0.2) & (torch.rand(len(controls), 1, 1) < 0.5)
        noisy = torch.where(hit, torch.where(torch.rand(controls.shape) < 0.5, 3.0, -2.0), controls)
        return mse_loss(self(noisy), weights)

    def trained(self, stage: int) -> list[nn.Module]:
        """Return the parts that learn in a stage."""
        return [self.regressor] if stage == 0 else [self.autoencoder]


KINDS: dict[str, Callable[[int], HSK16 | BSBS19]] = {"hsk16": HSK16, "bsbs19": BSBS19}


@dataclass(frozen=True, eq=False)
class Regressor:
    """A trained network with the controls it reads and their mean and spread, (controls,) in mm."""

    network: nn.Module
    controls: tuple[str, ...]
    mean: Array
    scale: Array

    def infer(self, controls: Array) -> Array:
        """Return weights, (frames, 52) in 0..1, of all eight control curves, (frames, 8) in mm."""
        frames, columns = len(controls), [CONTROL_INDEX[name] for name in self.controls]
        padded = np.pad(
            (controls[:, columns] - self.mean) / self.scale, ((0, -frames % ALIGNMENT), (0, 0)), mode="edge"
        )
        with torch.inference_mode():
            result = self.network(torch.tensor(padded.T[None], dtype=torch.float32))[0].numpy().T[:frames]
        return np.asarray(np.clip(result.astype(np.float64), 0.0, 1.0))


def load(name: str) -> Regressor:
    """Return a regressor that ships; raises `AssetError` where it is missing."""
    tensors, _ = load_model(MODELS / "controls.safetensors", kind="controls")
    prefix = f"{name}."
    own = {key.removeprefix(prefix): value for key, value in tensors.items() if key.startswith(prefix)}
    mean, scale = (own.pop(key).numpy().astype(np.float64) for key in ("mean", "scale"))
    network = KINDS[name](len(FEW))
    network.load_state_dict(own)
    return Regressor(network.eval(), FEW, mean, scale)


def train(data: Path, out: Path = MODELS, report: Report = print) -> dict[str, float]:
    """Train both kinds into one file; returns their validation errors."""
    training, validation, _ = split(data)
    material = performances(training, Help(), np.random.default_rng(SEED))
    valid = [piece.weights for piece in validation if piece.whole_face]
    tensors: dict[str, Tensor] = {}
    figures: dict[str, float] = {}
    for name in KINDS:
        regressor = _fitted(name, FEW, material)
        state = regressor.network.state_dict() | {
            "mean": torch.tensor(regressor.mean),
            "scale": torch.tensor(regressor.scale),
        }
        tensors |= {f"{name}.{key}": value for key, value in state.items()}
        result = [regressor.infer(bundled_measurer().measure(weights)) for weights in valid]
        error = float(np.concatenate([(a - b) ** 2 for a, b in zip(result, valid, strict=True)]).mean())
        figures[name] = round(error, 5)
        report(f"{name} with three controls: validation mse {error:.5f}")
    save_model(out / "controls.safetensors", tensors, kind="controls", config={})
    card = Card(
        "controls",
        {"recordings": sorted({piece.source for piece in training})},
        "train; figures on the last 15 % of each training take; test takes never seen",
        SEED,
        commit(),
        {"steps": STEPS, "batch": BATCH, "frames": FRAMES, "help": asdict(Help())},
        {"validation_mse": figures},
        "Baselines of the table `controls`; nothing else uses them.",
    )
    save_card(out / "controls.safetensors", card)
    return figures


def _fitted(name: str, chosen: tuple[str, ...], material: Sequence[Performance]) -> Regressor:
    torch.manual_seed(SEED)
    rng = np.random.default_rng(SEED)
    columns = [CONTROL_INDEX[control] for control in chosen]
    measured = bundled_measurer().measure(np.concatenate([each.weights[::5] for each in material]))[:, columns]
    mean, scale = measured.mean(axis=0), measured.std(axis=0)
    network = KINDS[name](len(chosen))
    for stage in (0, 1):
        network.requires_grad_(False)
        parts = nn.ModuleList(network.trained(stage)).requires_grad_(True)
        optimizer = torch.optim.Adam(parts.parameters(), lr=1e-3)
        pace = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, STEPS // 2, 1e-4)
        network.train()
        for _ in range(STEPS // 2):
            weights = np.stack([draw(material, FRAMES, rng).weights for _ in range(BATCH)])
            seen = (bundled_measurer().measure(weights.reshape(-1, len(SHAPES)))[:, columns] - mean) / scale
            pair = (seen.reshape(BATCH, FRAMES, -1), weights)
            curves, truth = (torch.tensor(x.transpose(0, 2, 1), dtype=torch.float32) for x in pair)
            loss = network.loss(curves, truth, stage)
            optimizer.zero_grad()
            loss.backward()  # type: ignore[no-untyped-call]
            optimizer.step()
            pace.step()
    return Regressor(network.eval(), chosen, mean, scale)
