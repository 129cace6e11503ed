"""The two networks of BSS20 section 3.2: a recurrent generator and a convolutional discriminator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from scipy.signal import lfilter
from torch import Tensor, nn
from torch.nn.utils.parametrizations import spectral_norm

from engine.inpaint.features import FEATURES
from engine.models.distances import SIX, Distances
from engine.take import SHAPES


@dataclass(frozen=True)
class Tuning:
    """Constants of the trained network, so that a change asks for a new training; ranges tried were not recorded."""

    widest: float = 8.0  # standard deviations at which features are clipped
    # Frames of correlation of each noise curve: from jitter to moods, so that spans of any length vary inside.
    memory_frames: tuple[float, ...] = (0.0, 4.0, 8.0, 15.0, 30.0, 30.0, 90.0, 90.0)


TUNING = Tuning()


def noise_curves(frames: int, rng: np.random.Generator) -> np.ndarray:
    """Return the generator's noise, (frames, 8) float32: Ornstein-Uhlenbeck processes of unit variance."""
    keep = np.exp(-1 / np.maximum(TUNING.memory_frames, 1e-9))
    shocks = rng.standard_normal((frames, len(keep)))
    shocks[1:] *= np.sqrt(1 - keep**2)
    curves = [lfilter([1.0], [1.0, -k], shock) for k, shock in zip(keep, shocks.T, strict=True)]
    return np.stack(curves, axis=1).astype(np.float32)


@dataclass(frozen=True)
class GeneratorConfig:
    """Sizes of the generator: paper values, but several noise curves where the paper has one."""

    features: int = FEATURES
    noise: int = len(TUNING.memory_frames)
    hidden: int = 128
    layers: int = 2
    dropout: float = 0.3
    filter_frames: int = 9


class Generator(nn.Module):
    """Maps features and noise to the residual of the base motion: two bidirectional LSTM layers, a dense layer, a filter.

    The recurrent path is the paper's network. The linear filter looks a few frames to either side; it carries what is
    nearly linear (jitter of a guide, the pose of a viseme, the step to a control target) past the narrow recurrent state.
    """

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
        width = config.filter_frames
        self.filter = nn.Conv1d(config.features + config.noise, len(SHAPES), width, padding=width // 2)
        for parameter in (*self.dense.parameters(), *self.filter.parameters()):
            nn.init.zeros_(parameter)
        self.register_buffer("scale", torch.ones(len(SHAPES)))

    def inputs(self, features: Tensor, noise: Tensor) -> Tensor:
        """Return the input of both paths, (batch, frames, FEATURES + noise)."""
        return torch.cat([features.clamp(-TUNING.widest, TUNING.widest), noise], dim=-1)

    def forward(self, features: Tensor, noise: Tensor) -> Tensor:
        """Return the residual, (batch, frames, 52), of features, (batch, frames, FEATURES), and noise of the same frames."""
        inputs = self.inputs(features, noise)
        recurrent, _ = self.recurrent(inputs)  # (batch, frames, 2 * hidden)
        near = self.filter(inputs.transpose(1, 2)).transpose(1, 2)  # (batch, frames, 52)
        motion: Tensor = (self.dense(self.drop(recurrent)) + near) * self.scale
        return motion


def discriminator_inputs(weights: Tensor, distances: Distances) -> Tensor:
    """Return the discriminator's input, (batch, frames, 116): weights, six distances, and the velocities of both.

    The paper's has poses alone, beside which small motions are too small to be told apart.
    """
    pose = torch.cat([weights, distances(weights)], dim=-1)
    return torch.cat([pose, torch.diff(pose, dim=1, prepend=pose[:, :1])], dim=-1)


class Discriminator(nn.Module):
    """Scores a performance: four strided convolutions with spectral norm and a dense layer (BSS20 section 3.2)."""

    scale: Tensor

    def __init__(self, frames: int, widths: tuple[int, ...] = (64, 32, 16, 8)) -> None:
        super().__init__()
        layers: list[nn.Module] = []
        inputs, left = 2 * (len(SHAPES) + len(SIX)), frames
        for width in widths:
            layers += [spectral_norm(nn.Conv1d(inputs, width, 3, stride=2, padding=1)), nn.LeakyReLU(0.2)]
            inputs, left = width, (left + 1) // 2
        self.layers = nn.Sequential(*layers, nn.Flatten(), nn.Linear(inputs * left, 1))
        self.register_buffer("scale", torch.ones(2 * (len(SHAPES) + len(SIX))))

    def forward(self, inputs: Tensor) -> Tensor:
        """Return scores, (batch,), of `discriminator_inputs`, (batch, frames, 116)."""
        score: Tensor = self.layers(inputs.transpose(1, 2))[:, 0]
        return score
