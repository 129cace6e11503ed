"""The six distances on the face that the training holds to (BSS20b section 3.2), in cm so that they weigh like weights."""

from __future__ import annotations

import torch
from torch import Tensor

from engine.character import bundled
from engine.controls import Control, Measurer
from engine.take import SHAPE_INDEX

_MM_PER_CM = 10.0

DISTANCES: tuple[Control, ...] = (
    Control("lips_middle", "lips apart", "lip_inner_upper", "lip_inner_lower", "lower"),
    Control("lips_left", "lips apart", "lip_inner_upper_left", "lip_inner_lower_left", "lower"),
    Control("lips_right", "lips apart", "lip_inner_upper_right", "lip_inner_lower_right", "lower"),
    Control("lips_horizontal", "mouth width", "mouth_right", "mouth_left", "lower"),
    Control("lids_left", "left eye", "lid_upper_left", "lid_lower_left", "eyelids"),
    Control("lids_right", "right eye", "lid_upper_right", "lid_lower_right", "eyelids"),
)


class Distances(torch.nn.Module):
    """`Measurer.measure` in torch and in cm: (batch, frames, 52) -> (batch, frames, 6)."""

    rest: Tensor
    basis: Tensor

    def __init__(self) -> None:
        super().__init__()
        rest, basis = Measurer(bundled(), DISTANCES).linear
        self.register_buffer("rest", torch.tensor(rest.reshape(-1) / _MM_PER_CM, dtype=torch.float32))
        self.register_buffer("basis", torch.tensor(basis / _MM_PER_CM, dtype=torch.float32))

    def forward(self, weights: Tensor) -> Tensor:
        """Measure; mouthClose counts no further than the jaw is open."""
        jaw, close = SHAPE_INDEX["jawOpen"], SHAPE_INDEX["mouthClose"]
        limited = torch.minimum(weights[..., close], weights[..., jaw].clamp(min=0))
        weights = torch.cat([weights[..., :close], limited[..., None], weights[..., close + 1 :]], dim=-1)
        moved = weights @ self.basis + self.rest
        vectors = moved.reshape(*moved.shape[:-1], -1, 3)
        return torch.sqrt(vectors.square().sum(dim=-1) + 1e-6)
