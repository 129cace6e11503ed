"""The network of BSBS19 figure 5 as the paper has it, with batch normalisation."""

from __future__ import annotations

import torch
from torch import Tensor, nn

ALIGNMENT = 4  # frames; two poolings by two


def _block(inputs: int, outputs: int) -> nn.Sequential:
    return nn.Sequential(nn.BatchNorm1d(inputs), nn.Conv1d(inputs, outputs, 3, padding=1), nn.ELU())


class BatchNormUNet(nn.Module):
    """Three resolutions with skip connections; `engine.regress.network.UNet` has a linear path in place of normalisation."""

    def __init__(self, inputs: int, outputs: int) -> None:
        super().__init__()
        self.down1, self.down2, self.bottom = _block(inputs, 32), _block(32, 64), _block(64, 128)
        self.up2, self.up1 = _block(192, 64), _block(96, 32)
        self.last = nn.Conv1d(32, outputs, 3, padding=1)
        self.pool, self.grow = nn.MaxPool1d(2), nn.Upsample(scale_factor=2)

    def forward(self, curves: Tensor) -> Tensor:
        """Map curves, (batch, inputs, frames) -> (batch, outputs, frames); frames are a multiple of `ALIGNMENT`."""
        fine = self.down1(curves)
        half = self.down2(self.pool(fine))
        half = self.up2(torch.cat([self.grow(self.bottom(self.pool(half))), half], dim=1))
        mapped: Tensor = self.last(self.up1(torch.cat([self.grow(half), fine], dim=1)))
        return mapped
