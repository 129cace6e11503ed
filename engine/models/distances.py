"""Distances on the face as a differentiable layer, for losses and discriminators that look at lips and lids."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from engine.controls import Measurer
from engine.take import SHAPE_INDEX

_JAW, _CLOSE = SHAPE_INDEX["jawOpen"], SHAPE_INDEX["mouthClose"]


class Distances(nn.Module):
    """`Measurer.measure` in torch: weights, (..., 52), to distances, (..., controls) in mm."""

    rest: Tensor
    basis: Tensor

    def __init__(self, measurer: Measurer) -> None:
        super().__init__()
        rest, basis = measurer.linear
        self.register_buffer("rest", torch.tensor(rest, dtype=torch.float32), persistent=False)
        self.register_buffer("basis", torch.tensor(basis, dtype=torch.float32), persistent=False)

    def forward(self, weights: Tensor) -> Tensor:
        """Measure; mouthClose counts no further than the jaw is open."""
        close = torch.minimum(weights[..., _CLOSE], weights[..., _JAW].clamp(min=0))
        weights = torch.cat([weights[..., :_CLOSE], close[..., None], weights[..., _CLOSE + 1 :]], dim=-1)
        moved = weights @ self.basis  # (..., controls * 3)
        vectors = moved.reshape(*moved.shape[:-1], -1, 3) + self.rest
        return torch.sqrt(vectors.square().sum(dim=-1) + 1e-6)
