"""The pose expected of control curves, E[weights | controls]: the base motion of a fill with control targets."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from engine.controls import CONTROLS
from engine.models.checkpoint import MODELS, load_model, rebuilt
from engine.models.threads import one_thread
from engine.models.unet import ALIGNMENT, BatchNormUNet
from engine.take import SHAPES, Array


@dataclass(frozen=True)
class Tuning:
    """Size of the ensemble; part of the trained model."""

    members: int = 3  # networks whose mean is taken [1, 3]; a single network errs 3 % more on validation takes


TUNING = Tuning()


class Expected(nn.Module):
    """Predicts weights from curves of any of the controls, as the mean of several U-Nets."""

    rest: Tensor
    spread: Tensor
    mean: Tensor
    scale: Tensor

    def __init__(self, members: int = TUNING.members) -> None:
        super().__init__()
        self.members = nn.ModuleList(BatchNormUNet(2 * len(CONTROLS), len(SHAPES)) for _ in range(members))
        for name, size, value in (("rest", len(CONTROLS), 0.0), ("mean", len(SHAPES), 0.0)):
            self.register_buffer(name, torch.full((size,), value))
        for name, size in (("spread", len(CONTROLS)), ("scale", len(SHAPES))):
            self.register_buffer(name, torch.ones(size))

    def forward(self, controls: Tensor) -> Tensor:
        """Return weights, (batch, frames, 52), of controls, (batch, frames, 8) in mm, NaN where there is no target."""
        given = torch.isfinite(controls)
        seen = torch.where(given, (controls - self.rest) / self.spread, 0.0)
        seen = torch.cat([seen, given.to(seen.dtype)], dim=-1).transpose(1, 2)  # (batch, 16, frames)
        weights: Tensor = torch.stack([member(seen) for member in self.members]).mean(dim=0).transpose(1, 2)
        return weights * self.scale + self.mean

    def pose(self, controls: Array) -> Array:
        """Return weights, (frames, 52) in 0..1, of control curves, (frames, 8) in mm, NaN where there is no target."""
        padded = np.pad(controls, ((0, -len(controls) % ALIGNMENT), (0, 0)), mode="edge")
        with torch.inference_mode(), one_thread():
            weights = self(torch.tensor(padded[None], dtype=torch.float32))[0, : len(controls)].numpy()
        return np.asarray(np.clip(weights.astype(np.float64), 0.0, 1.0))


def load(path: Path = MODELS / "expected.safetensors") -> Expected:
    """Read the networks; raises `AssetError` where they are missing or damaged."""
    tensors, config = load_model(path, kind="expected")
    return rebuilt(lambda: Expected(**config), tensors, path, kind="expected")


@lru_cache(maxsize=1)
def bundled() -> Expected:
    """Return the networks that ship with the program."""
    return load()
