"""A resolution-preserving U-Net over time (BSBS19 figure 5) beside a linear map frame by frame."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor, nn
from torch.nn.functional import conv1d, elu, max_pool1d, pad

SHORT = 512  # batch * frames, below which a matrix product is the faster convolution; at 1000 it takes twice as long
BEND = 2.0  # radians by which a wave turns over a standard deviation [0.5..2.5]; lids of people left out err least so


@dataclass(frozen=True)
class UNetConfig:
    """Widths of the three resolutions, and what goes in and comes out.

    Attributes
    ----------
    waves : random ones, by which the linear part bends (Rahimi and Recht 2007)
    further : inputs after the others that need not be given
    """

    inputs: int
    outputs: int
    widths: tuple[int, int, int] = (32, 64, 128)
    waves: int = 0
    further: int = 0

    @property
    def channels(self) -> int:
        """How many the convolutions see: all inputs and, where some need not be given, whether they are."""
        return self.inputs + self.further + (self.further > 0)


def _block(inputs: int, outputs: int) -> nn.Sequential:
    return nn.Sequential(
        nn.Conv1d(inputs, outputs, 3, padding=1), nn.ELU(), nn.Conv1d(outputs, outputs, 3, padding=1), nn.ELU()
    )


def _twice(x: Tensor, kernels: Sequence[Tensor]) -> Tensor:
    """Run a block."""
    first, bias, second, offset = kernels
    x = elu(_convolved(x, first, bias), inplace=True)
    return elu(_convolved(x, second, offset), inplace=True)


def _convolved(x: Tensor, kernel: Tensor, bias: Tensor) -> Tensor:
    """Return what a convolution of width 1 or 3 makes of curves, (batch, n, frames), with zeros beyond their ends.

    Of few frames as one matrix product: torch's own convolution then takes twice as long to set itself up as to work.
    """
    batch, count, frames = x.shape
    width = kernel.shape[2]
    if batch * frames > SHORT:
        return conv1d(x, kernel, bias, padding=width // 2)
    if width > 1:
        wide = pad(x, (1, 1))
        x = torch.stack([wide[..., :-2], x, wide[..., 2:]], dim=2).flatten(1, 2)
    return torch.baddbmm(bias[:, None], kernel.reshape(1, -1, count * width).expand(batch, -1, -1), x)


def _grown(x: Tensor) -> Tensor:
    """Return every frame twice."""
    return x.unsqueeze(3).expand(-1, -1, -1, 2).flatten(2)


class UNet(nn.Module):
    """A linear map frame by frame plus a 1-D U-Net over time: (batch, inputs, frames) -> (batch, outputs, frames).

    Further inputs that are not given are NaN or left out; where they are, another linear map counts. The paper's batch
    normalisation is left out: under salt-and-pepper its statistics drift and ruin closures. Inputs are standardised by
    constants instead, and the linear part starts as ridge regression.
    """

    mean: Tensor
    scale: Tensor
    turns: Tensor
    more_turns: Tensor
    phases: Tensor

    def __init__(self, config: UNetConfig) -> None:
        super().__init__()
        narrow, middle, wide = config.widths
        self.config = config
        every = config.inputs + config.further
        self.linear = nn.Conv1d(config.inputs + config.waves, config.outputs, 1)
        self.more = nn.Conv1d(every + config.waves, config.outputs, 1) if config.further else None
        if config.waves:
            self.register_buffer("turns", BEND * torch.randn(config.waves, config.inputs, 1) / math.sqrt(config.inputs))
            self.register_buffer("more_turns", BEND * torch.randn(config.waves, every, 1) / math.sqrt(every))
            self.register_buffer("phases", 2 * math.pi * torch.rand(config.waves))
        self.down1, self.down2 = _block(config.channels, narrow), _block(narrow, middle)
        self.bottom = _block(middle, wide)
        self.up2, self.up1 = _block(wide + middle, middle), _block(middle + narrow, narrow)
        self.last = nn.Conv1d(narrow, config.outputs, 1)
        nn.init.zeros_(self.last.weight)
        nn.init.zeros_(self.last.bias)  # type: ignore[arg-type]
        # Run by hand: called as modules, networks this small spend a quarter of a drag step on the way to their kernels.
        blocks = (self.down1, self.down2, self.bottom, self.up2, self.up1)
        self._kernels = [list(block.parameters()) for block in blocks]
        self._pointwise = [list(layer.parameters()) for layer in (self.linear, self.more, self.last) if layer]
        self.register_buffer("mean", torch.zeros(1, every, 1))
        self.register_buffer("scale", torch.ones(1, every, 1))

    def forward(self, curves: Tensor) -> Tensor:
        """Map curves; frames must be a multiple of `ALIGNMENT`."""
        x, given = self._inputs(curves)
        down1, down2, bottom, up2, up1 = self._kernels
        fine = _twice(x, down1)  # (batch, narrow, frames)
        half = _twice(max_pool1d(fine, 2), down2)  # (batch, middle, frames / 2)
        deep = _twice(max_pool1d(half, 2), bottom)  # (batch, wide, frames / 4)
        half = _twice(torch.cat([_grown(deep), half], dim=1), up2)
        fine = _twice(torch.cat([_grown(half), fine], dim=1), up1)
        return self._straight(x, given) + _convolved(fine, *self._pointwise[-1])

    def _inputs(self, curves: Tensor) -> tuple[Tensor, Tensor | None]:
        """Return what the convolutions see, (batch, channels, frames), and where all is given, (batch, 1, frames).

        What is not given is at its mean; None stands for no frame at all.
        """
        own, further = self.config.inputs, self.config.further
        if not further:
            return (curves - self.mean) / self.scale, None
        if curves.shape[1] == own:
            x = (curves - self.mean[:, :own]) / self.scale[:, :own]
            return pad(x, (0, 0, 0, further + 1)), None
        x = (curves - self.mean) / self.scale
        given = ~x.isnan().any(dim=1, keepdim=True)
        x = torch.cat([x[:, :own], torch.where(given, x[:, own:], 0.0), given.to(x.dtype)], dim=1)
        return x, given

    def straight(self, curves: Tensor) -> Tensor:
        """Return what the linear part alone says of curves."""
        return self._straight(*self._inputs(curves))

    def _straight(self, x: Tensor, given: Tensor | None) -> Tensor:
        """Return what the linear part says, (batch, outputs, frames), of what the convolutions see."""
        linear = self._pointwise[0]
        if given is None:
            return _convolved(self.bent(x[:, : self.config.inputs]), *linear)
        every = _convolved(self.bent(x[:, :-1]), *self._pointwise[1])
        if given.all():
            return every
        return torch.where(given, every, _convolved(self.bent(x[:, : self.config.inputs]), *linear))

    def bent(self, x: Tensor) -> Tensor:
        """Return what a linear part sees of standardised inputs, (batch, inputs, frames): these and their waves."""
        if not self.config.waves:
            return x
        turns = self.turns if x.shape[1] == self.config.inputs else self.more_turns
        return torch.cat([x, math.sqrt(2.0) * conv1d(x, turns, self.phases).cos()], dim=1)
