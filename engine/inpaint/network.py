"""The two networks of BSS20 section 3.2: a recurrent generator and a convolutional discriminator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from scipy.signal import lfilter
from torch import Tensor, nn
from torch.nn.utils.parametrizations import spectral_norm

from engine.inpaint.gap import FEATURES
from engine.models.distances import SIX, Distances
from engine.take import SHAPES

_WIDEST = 8.0  # spreads; beyond it a feature tells nothing more
# Frames over which each curve of noise forgets itself: from jitter to moods, so that a span of any length changes its mind.
MEMORY_FRAMES = (0.0, 4.0, 8.0, 15.0, 30.0, 30.0, 90.0, 90.0)


def noise_curves(frames: int, rng: np.random.Generator) -> np.ndarray:
    """Return what a fill is drawn from, (frames, 8) float32: Ornstein-Uhlenbeck curves of unit variance."""
    keep = np.exp(-1 / np.maximum(MEMORY_FRAMES, 1e-9))
    shocks = rng.standard_normal((frames, len(keep)))
    shocks[1:] *= np.sqrt(1 - keep**2)
    curves = [lfilter([1.0], [1.0, -k], shock) for k, shock in zip(keep, shocks.T, strict=True)]
    return np.stack(curves, axis=1).astype(np.float32)


@dataclass(frozen=True)
class GeneratorConfig:
    """Sizes of the generator: paper values, with several curves of noise where it has one."""

    features: int = FEATURES
    noise: int = len(MEMORY_FRAMES)
    hidden: int = 128
    layers: int = 2
    dropout: float = 0.3
    filter_frames: int = 9


class Generator(nn.Module):
    """Two bidirectional LSTM layers and a dense one, beside a linear filter: features and noise to the motion to add.

    The paper's network is the recurrent path. The filter looks a few frames to either side; it carries what is nearly
    linear (jitter to take off a guide, the pose of a viseme, the pull of a control) past the narrow recurrent state.
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

    def seen(self, features: Tensor, noise: Tensor) -> Tensor:
        """Return what both paths look at, (batch, frames, FEATURES + noise)."""
        return torch.cat([features.clamp(-_WIDEST, _WIDEST), noise], dim=-1)

    def forward(self, features: Tensor, noise: Tensor) -> Tensor:
        """Return motion, (batch, frames, 52), of features, (batch, frames, FEATURES), and noise of the same frames."""
        seen = self.seen(features, noise)
        remembered, _ = self.recurrent(seen)  # (batch, frames, 2 * hidden)
        near = self.filter(seen.transpose(1, 2)).transpose(1, 2)  # (batch, frames, 52)
        motion: Tensor = (self.dense(self.drop(remembered)) + near) * self.scale
        return motion


def see(weights: Tensor, distances: Distances) -> Tensor:
    """Return what the discriminator looks at, (batch, frames, 116): weights, six distances, and the velocities of both.

    The paper shows it poses alone; beside them the little motions that make a face alive are too small to be seen.
    """
    pose = torch.cat([weights, distances(weights)], dim=-1)
    return torch.cat([pose, torch.diff(pose, dim=1, prepend=pose[:, :1])], dim=-1)


class Discriminator(nn.Module):
    """Four strided convolutions with spectral norm and one dense layer: a performance to a score."""

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

    def forward(self, seen: Tensor) -> Tensor:
        """Return scores, (batch,), of what `see` returns, (batch, frames, 116)."""
        score: Tensor = self.layers(seen.transpose(1, 2))[:, 0]
        return score
