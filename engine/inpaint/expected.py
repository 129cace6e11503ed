"""The face to expect where some controls run as they run: what lies under a fill that control curves steer."""

from __future__ import annotations

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

MEMBERS = 3  # one errs three per cent more on validation takes


class Expected(nn.Module):
    """The mean of several U-Nets, each of which knows any of the controls: curves, and which are given, to weights."""

    rest: Tensor
    spread: Tensor
    mean: Tensor
    scale: Tensor

    def __init__(self, members: int = MEMBERS) -> None:
        super().__init__()
        self.members = nn.ModuleList(BatchNormUNet(2 * len(CONTROLS), len(SHAPES)) for _ in range(members))
        for name, size, value in (("rest", len(CONTROLS), 0.0), ("mean", len(SHAPES), 0.0)):
            self.register_buffer(name, torch.full((size,), value))
        for name, size in (("spread", len(CONTROLS)), ("scale", len(SHAPES))):
            self.register_buffer(name, torch.ones(size))

    def forward(self, controls: Tensor) -> Tensor:
        """Return weights, (batch, frames, 52), of controls, (batch, frames, 8) in mm, NaN where nothing is said."""
        given = torch.isfinite(controls)
        seen = torch.where(given, (controls - self.rest) / self.spread, 0.0)
        seen = torch.cat([seen, given.to(seen.dtype)], dim=-1).transpose(1, 2)  # (batch, 16, frames)
        made: Tensor = torch.stack([member(seen) for member in self.members]).mean(dim=0).transpose(1, 2)
        return made * self.scale + self.mean

    def face(self, controls: Array) -> Array:
        """Return weights, (frames, 52) in 0..1, of control curves, (frames, 8) in mm, NaN where nothing is said."""
        held = np.pad(controls, ((0, -len(controls) % ALIGNMENT), (0, 0)), mode="edge")
        with torch.inference_mode(), one_thread():
            made = self(torch.tensor(held[None], dtype=torch.float32))[0, : len(controls)].numpy()
        return np.asarray(np.clip(made.astype(np.float64), 0.0, 1.0))


def load(path: Path = MODELS / "expected.safetensors") -> Expected:
    """Read the networks; raises `AssetError` where they are missing or damaged."""
    tensors, config = load_model(path, kind="expected")
    return rebuilt(lambda: Expected(**config), tensors, path, kind="expected")


@lru_cache(maxsize=1)
def bundled() -> Expected:
    """Return the networks that ship with the program."""
    return load()
