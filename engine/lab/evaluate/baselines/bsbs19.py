"""BSBS19 as printed: blocks of batch normalisation, convolution and ELU, at the paper's own settings.

What the paper leaves open is filled in plainly: 32, 64 and 128 filters; the L2 term is the mean square of the network's
parameters (so that beta = 1 leaves the data term in charge, as it must have); distances count in decimetres, the unit
in which they and the weights are of like size and alpha = 1 balances them.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor, nn
from torch.nn.functional import mse_loss

from engine.controls import bundled_measurer
from engine.lab.evaluate.baselines.parts import Areas, Material, Report, fit, restore
from engine.lab.train.regress.requests import salt_and_pepper
from engine.models.distances import Distances
from engine.regress.areas import Area
from engine.regress.network import ALIGNMENT
from engine.take import SHAPES

WIDTHS = (32, 64, 128)
ALPHA, BETA, NOISE = 1.0, 1.0, 0.2
MM_PER_UNIT = 100.0
EPOCHS = (30, 30)


def _block(inputs: int, outputs: int) -> nn.Sequential:
    return nn.Sequential(nn.BatchNorm1d(inputs), nn.Conv1d(inputs, outputs, 3, padding=1), nn.ELU())


class PaperUNet(nn.Module):
    """The network of figure 5: three resolutions, skip connections, no linear path."""

    def __init__(self, inputs: int, outputs: int) -> None:
        super().__init__()
        narrow, middle, wide = WIDTHS
        self.down1, self.down2, self.bottom = _block(inputs, narrow), _block(narrow, middle), _block(middle, wide)
        self.up2, self.up1 = _block(wide + middle, middle), _block(middle + narrow, narrow)
        self.last = nn.Conv1d(narrow, outputs, 3, padding=1)
        self.pool, self.grow = nn.MaxPool1d(2), nn.Upsample(scale_factor=2)

    def forward(self, curves: Tensor) -> Tensor:
        """Map curves, (batch, inputs, frames) -> (batch, outputs, frames)."""
        fine = self.down1(curves)
        half = self.down2(self.pool(fine))
        deep = self.bottom(self.pool(half))
        half = self.up2(torch.cat([self.grow(deep), half], dim=1))
        mapped: Tensor = self.last(self.up1(torch.cat([self.grow(half), fine], dim=1)))
        return mapped


class BSBS19(nn.Module):
    """Autoencoder on regressor, controls with their means subtracted."""

    mean: Tensor

    def __init__(self, inputs: int, outputs: int) -> None:
        super().__init__()
        self.regressor, self.autoencoder = PaperUNet(inputs, outputs), PaperUNet(outputs, outputs)
        self.register_buffer("mean", torch.zeros(1, inputs, 1))

    def forward(self, controls: Tensor) -> Tensor:
        """Return weights, (batch, shapes, frames), of controls, (batch, controls, frames) in mm."""
        weights: Tensor = self.autoencoder(self.regressor(controls - self.mean))
        return weights


def _size(module: nn.Module) -> Tensor:
    parameters = torch.cat([parameter.flatten() for parameter in module.parameters()])
    return parameters.square().mean()


def _train_area(material: Material) -> tuple[BSBS19, float]:
    torch.manual_seed(material.source.seed)
    controls, weights = material.pick(material.source.first)
    network = BSBS19(controls.shape[1], weights.shape[1])
    network.mean.copy_(controls.mean(dim=(0, 2))[None, :, None])
    low, high = (bound.reshape(1, -1, 1) for bound in (controls.amin(dim=(0, 2)), controls.amax(dim=(0, 2))))
    noise = torch.Generator().manual_seed(material.source.seed)
    distances, columns = Distances(bundled_measurer()), torch.tensor(material.area.shape_columns)
    seen_columns = torch.tensor(material.area.control_columns)

    def regressed(controls: Tensor, weights: Tensor) -> Tensor:
        result = network.regressor(controls - network.mean)
        return mse_loss(result, weights) + BETA * _size(network.regressor)

    def cleaned(controls: Tensor, weights: Tensor) -> Tensor:
        result = network(salt_and_pepper(controls, low, high, NOISE, noise))
        whole = torch.zeros(len(result), len(SHAPES), result.shape[2])
        error = [distances(whole.index_copy(1, columns, part).mT)[..., seen_columns] for part in (result, weights)]
        distance = mse_loss(error[0] / MM_PER_UNIT, error[1] / MM_PER_UNIT)
        return mse_loss(result, weights) + ALPHA * distance + BETA * _size(network.autoencoder)

    fit(network.regressor, regressed, material, epochs=EPOCHS[0], key=21)
    network.regressor.requires_grad_(False)
    # `fit` puts the whole network in training mode: the frozen regressor's batch statistics still move, as in the paper.
    return network, fit(network, cleaned, material, epochs=EPOCHS[1], key=22)


def train(materials: list[Material], report: Report) -> tuple[dict[str, nn.Module], dict[str, Any]]:
    """Train each area; returns the modules and their figures."""
    modules: dict[str, nn.Module] = {}
    figures: dict[str, Any] = {}
    for material in materials:
        modules[material.area.name], error = _train_area(material)
        figures[material.area.name] = {"loss": error}
        report(f"bsbs19 {material.area.name}: validation loss {error:.5f}")
    return modules, figures


def load() -> Areas:
    """Return the baseline that ships."""

    def empty(area: Area, _: dict[str, Any]) -> BSBS19:
        return BSBS19(len(area.controls), len(area.shape_columns))

    return Areas(restore("bsbs19", empty), alignment=ALIGNMENT)
