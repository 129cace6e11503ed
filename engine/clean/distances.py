"""The six distances on the face that the training holds to (BSS20b section 3.2), in cm so that they weigh like weights."""

from __future__ import annotations

import torch
from torch import Tensor

from engine.character import bundled
from engine.controls import Control, Measurer
from engine.take import SHAPE_INDEX

_LIP, _LID = ("lip_inner_upper", "lip_inner_lower"), ("lid_upper", "lid_lower")
DISTANCES: tuple[Control, ...] = (
    Control("lips_middle", "lips apart", *_LIP, "lower"),
    *(Control(f"lips_{side}", "lips apart", *(f"{end}_{side}" for end in _LIP), "lower") for side in ("left", "right")),
    Control("lips_horizontal", "mouth width", "mouth_right", "mouth_left", "lower"),
    *(Control(f"lids_{side}", "eye", *(f"{end}_{side}" for end in _LID), "eyelids") for side in ("left", "right")),
)
_MM_PER_CM = 10.0


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
        vectors = (weights @ self.basis + self.rest).unflatten(-1, (-1, 3))
        return torch.sqrt(vectors.square().sum(dim=-1) + 1e-6)
