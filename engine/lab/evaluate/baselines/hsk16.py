"""The body-motion system of Holden, Saito and Komura 2016, adapted to faces as BSBS19 section 5.1 describes.

A time-convolutional autoencoder with one layer each way learns a space of motion; a convolutional network of two layers
regresses the controls to that space; one such system for each area of the face.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor, nn
from torch.nn.functional import mse_loss

from engine.lab.evaluate.baselines.parts import Areas, Material, Report, columns_of, fit, restore
from engine.regress.areas import Area

UNITS, HIDDEN = 128, 64
WIDTHS = (
    7,
    15,
)  # frames that a filter sees; 15 at 30 fps last as long as the paper's 25 to 31 at 60; best on validation
POOL = 2
CORRUPTED = 0.1  # share of inputs that the autoencoder must do without in training
SPARSITY = 0.01
LATENT_SHARE = 0.01
EPOCHS = (20, 20)


class Motion(nn.Module):
    """The autoencoder: convolution, ReLU, max pooling; upsampling and one convolution back."""

    def __init__(self, shapes: int, width: int) -> None:
        super().__init__()
        self.encode = nn.Sequential(nn.Conv1d(shapes, UNITS, width, padding=width // 2), nn.ReLU(), nn.MaxPool1d(POOL))
        self.decode = nn.Sequential(nn.Upsample(scale_factor=POOL), nn.Conv1d(UNITS, shapes, width, padding=width // 2))
        self.corrupt = nn.Dropout(CORRUPTED)

    def forward(self, weights: Tensor) -> Tensor:
        """Return weights, (batch, shapes, frames), as the space of motion holds them."""
        held: Tensor = self.decode(self.encode(self.corrupt(weights)))
        return held


class HSK16(nn.Module):
    """Controls to motion space to weights."""

    mean: Tensor
    scale: Tensor
    centre: Tensor

    def __init__(self, inputs: int, outputs: int, width: int) -> None:
        super().__init__()
        pad = width // 2
        self.motion = Motion(outputs, width)
        self.regress = nn.Sequential(
            *(nn.Conv1d(inputs, HIDDEN, width, padding=pad), nn.ReLU()),
            *(nn.Conv1d(HIDDEN, UNITS, width, padding=pad), nn.ReLU(), nn.MaxPool1d(POOL)),
        )
        self.register_buffer("mean", torch.zeros(1, inputs, 1))
        self.register_buffer("scale", torch.ones(1, inputs, 1))
        self.register_buffer("centre", torch.zeros(1, outputs, 1))

    def forward(self, controls: Tensor) -> Tensor:
        """Return weights, (batch, shapes, frames), of controls, (batch, controls, frames) in mm."""
        latent = self.regress((controls - self.mean) / self.scale)
        weights: Tensor = self.motion.decode(latent) + self.centre
        return weights

    def latent_error(self, controls: Tensor, weights: Tensor) -> Tensor:
        """Return how far the regressed motion is from the encoded one, and the weights from the true ones."""
        latent = self.regress((controls - self.mean) / self.scale)
        made = self.motion.decode(latent) + self.centre
        encoded = self.motion.encode(weights - self.centre)
        return mse_loss(made, weights) + LATENT_SHARE * mse_loss(latent, encoded)


def _train_area(material: Material, width: int, epochs: tuple[int, int]) -> tuple[HSK16, float]:
    torch.manual_seed(material.source.seed)
    controls, weights = material.pick(material.source.first)
    network = HSK16(controls.shape[1], weights.shape[1], width)
    network.mean.copy_(controls.mean(dim=(0, 2))[None, :, None])
    network.scale.copy_(controls.std(dim=(0, 2))[None, :, None])
    network.centre.copy_(weights.mean(dim=(0, 2))[None, :, None])
    motion = network.motion

    def held(_: Tensor, weights: Tensor) -> Tensor:
        centred = weights - network.centre
        sparse = torch.stack([parameter.abs().mean() for parameter in motion.parameters()]).mean()
        return mse_loss(motion(centred), centred) + SPARSITY * sparse

    fit(motion, held, material, epochs=epochs[0], key=11, batch=32)
    motion.requires_grad_(False)

    def regressed(controls: Tensor, weights: Tensor) -> Tensor:
        return mse_loss(network(controls), weights)

    best = fit(network, network.latent_error, material, epochs=epochs[1], key=12, score=regressed, batch=32)
    return network, best


def train(
    materials: list[Material], report: Report, *, epochs: tuple[int, int] = EPOCHS
) -> tuple[dict[str, nn.Module], dict[str, Any]]:
    """Train each area with each filter width and keep the one that validates best; returns modules and figures."""
    modules: dict[str, nn.Module] = {}
    figures: dict[str, Any] = {}
    for material in materials:
        name = material.area.name
        for width in WIDTHS:
            network, error = _train_area(material, width, epochs)
            report(f"hsk16 {name}: filters of {width} frames, validation mse {error:.5f}")
            if name not in modules or error < figures[name]["mse"]:
                modules[name], figures[name] = network, {"width": width, "mse": error}
    return modules, figures


def load(*, every: bool = False) -> Areas:
    """Return the baseline that ships, or the same with the extended controls."""

    def empty(area: Area, width: int) -> HSK16:
        return HSK16(len(columns_of(area, every=every)), len(area.shape_columns), width)

    modules = restore("hsk16_16" if every else "hsk16", lambda area, figures: empty(area, figures["width"]))
    return Areas(modules, alignment=POOL, every=every)
