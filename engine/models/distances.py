"""Distances on the face as a differentiable layer, for losses and discriminators that look at lips and lids."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from engine.character import bundled
from engine.controls import Control, Measurer
from engine.jaw import CLOSE, JAW

# The six distances of BSS20 section 3.3 and BSS20b section 3.2: lips at three places, mouth corners, both lids.
SIX: tuple[Control, ...] = (
    Control("lips_middle", "lips, middle", "lip_inner_upper", "lip_inner_lower", "lower"),
    Control("lips_right", "lips, right", "lip_inner_upper_right", "lip_inner_lower_right", "lower"),
    Control("lips_left", "lips, left", "lip_inner_upper_left", "lip_inner_lower_left", "lower"),
    Control("corners", "mouth width", "mouth_right", "mouth_left", "lower"),
    Control("lids_right", "right eye", "lid_upper_right", "lid_lower_right", "eyelids"),
    Control("lids_left", "left eye", "lid_upper_left", "lid_lower_left", "eyelids"),
)


class Distances(nn.Module):
    """`Measurer.measure` in torch: weights, (..., 52), to distances, (..., controls) in mm, or in another unit."""

    rest: Tensor
    basis: Tensor

    def __init__(self, measurer: Measurer, *, unit_mm: float = 1.0) -> None:
        super().__init__()
        rest, basis = measurer.linear
        self.register_buffer("rest", torch.tensor(rest / unit_mm, dtype=torch.float32), persistent=False)
        self.register_buffer("basis", torch.tensor(basis / unit_mm, dtype=torch.float32), persistent=False)

    def forward(self, weights: Tensor) -> Tensor:
        """Measure; mouthClose counts no further than the jaw is open."""
        close = torch.minimum(weights[..., CLOSE], weights[..., JAW].clamp(min=0))
        weights = torch.cat([weights[..., :CLOSE], close[..., None], weights[..., CLOSE + 1 :]], dim=-1)
        moved = weights @ self.basis  # (..., controls * 3)
        vectors = moved.reshape(*moved.shape[:-1], -1, 3) + self.rest
        return torch.sqrt(vectors.square().sum(dim=-1) + 1e-6)


def six_distances(*, unit_mm: float = 1.0) -> Distances:
    """Return the layer that measures the six distances on the bundled head."""
    return Distances(Measurer(bundled(), SIX), unit_mm=unit_mm)
