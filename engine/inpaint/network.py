"""The two networks of BSS20 section 3.2: a recurrent generator and a convolutional discriminator."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn
from torch.nn.utils.parametrizations import spectral_norm

from engine.character import bundled
from engine.controls import Control, Measurer
from engine.inpaint.gap import FEATURES
from engine.models.distances import Distances
from engine.take import SHAPES

# The six distances of BSS20 section 3.3: lips at three places, mouth corners, both lids.
SIX: tuple[Control, ...] = (
    Control("lips_middle", "lips, middle", "lip_inner_upper", "lip_inner_lower", "lower"),
    Control("lips_right", "lips, right", "lip_inner_upper_right", "lip_inner_lower_right", "lower"),
    Control("lips_left", "lips, left", "lip_inner_upper_left", "lip_inner_lower_left", "lower"),
    Control("corners", "mouth width", "mouth_right", "mouth_left", "lower"),
    Control("lids_right", "right eye", "lid_upper_right", "lid_lower_right", "eyelids"),
    Control("lids_left", "left eye", "lid_upper_left", "lid_lower_left", "eyelids"),
)


def six_distances() -> Distances:
    """Return the layer that measures the six distances on the bundled head."""
    return Distances(Measurer(bundled(), SIX))


@dataclass(frozen=True)
class GeneratorConfig:
    """Sizes of the generator: paper values, with four noise curves where it has one."""

    features: int = FEATURES
    noise: int = 4
    hidden: int = 128
    layers: int = 2
    dropout: float = 0.3


class Generator(nn.Module):
    """Two bidirectional LSTM layers and a dense one: features and noise to the motion to add, before its rise."""

    scale: Tensor

    def __init__(self, config: GeneratorConfig) -> None:
        super().__init__()
        self.config = config
        self.recurrent = nn.LSTM(
            config.features + config.noise,
            config.hidden,
            config.layers,
            batch_first=True,
            bidirectional=True,
            dropout=config.dropout,
        )
        self.drop = nn.Dropout(config.dropout)
        self.dense = nn.Linear(2 * config.hidden, len(SHAPES))
        nn.init.zeros_(self.dense.weight)
        nn.init.zeros_(self.dense.bias)
        self.register_buffer("scale", torch.ones(len(SHAPES)))

    def forward(self, features: Tensor, noise: Tensor) -> Tensor:
        """Return motion, (batch, frames, 52), of features, (batch, frames, FEATURES), and noise of the same frames."""
        remembered, _ = self.recurrent(torch.cat([features, noise], dim=-1))  # (batch, frames, 2 * hidden)
        motion: Tensor = self.dense(self.drop(remembered)) * self.scale
        return motion


class Discriminator(nn.Module):
    """Four strided convolutions with spectral norm and one dense layer: weights and six distances to a score."""

    scale: Tensor

    def __init__(self, frames: int, widths: tuple[int, ...] = (64, 32, 16, 8)) -> None:
        super().__init__()
        layers: list[nn.Module] = []
        inputs, left = len(SHAPES) + len(SIX), frames
        for width in widths:
            layers += [spectral_norm(nn.Conv1d(inputs, width, 3, stride=2, padding=1)), nn.LeakyReLU(0.2)]
            inputs, left = width, (left + 1) // 2
        self.layers = nn.Sequential(*layers, nn.Flatten(), nn.Linear(inputs * left, 1))
        self.register_buffer("scale", torch.ones(len(SHAPES) + len(SIX)))

    def forward(self, face: Tensor) -> Tensor:
        """Return scores, (batch,), of weights beside their six distances in mm, (batch, frames, 58)."""
        score: Tensor = self.layers((face / self.scale).transpose(1, 2))[:, 0]
        return score
