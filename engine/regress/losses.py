"""The terms that training minimises: weights, distances on the face (BSBS19 equation 1), velocity."""

from __future__ import annotations

import torch
from torch import Tensor

from engine.controls import CONTROLS, bundled_measurer
from engine.take import SHAPE_INDEX

CLOSED_MM = 3.0  # distances of this order are lips and lids about to meet


class Distances(torch.nn.Module):
    """`Measurer.measure` in torch: weights, (batch, 52, frames) -> controls, (batch, 8, frames) in mm."""

    rest: Tensor
    basis: Tensor

    def __init__(self) -> None:
        super().__init__()
        rest, basis = bundled_measurer().linear
        self.register_buffer("rest", torch.tensor(rest, dtype=torch.float32))
        self.register_buffer("basis", torch.tensor(basis, dtype=torch.float32))

    def forward(self, weights: Tensor) -> Tensor:
        """Measure; mouthClose counts no further than the jaw is open."""
        jaw, close = SHAPE_INDEX["jawOpen"], SHAPE_INDEX["mouthClose"]
        limited = torch.minimum(weights[:, close], weights[:, jaw].clamp(min=0))
        weights = torch.cat([weights[:, :close], limited[:, None], weights[:, close + 1 :]], dim=1)
        vectors = torch.einsum("bst,sk->bkt", weights, self.basis)
        vectors = vectors.reshape(len(weights), len(CONTROLS), 3, -1) + self.rest[None, :, :, None]
        return torch.sqrt(vectors.square().sum(dim=2) + 1e-6)


def distance_error(made: Tensor, asked: Tensor, closure_gain: float) -> Tensor:
    """Return the mean squared error of distances, in mm^2, raised by up to `closure_gain` where lips or lids meet.

    Where they should meet and where they do: a closure invented weighs like a closure missed.
    """
    nearer = torch.minimum(made.detach(), asked)
    urgency = 1.0 + closure_gain * torch.exp(-((nearer / CLOSED_MM) ** 2))
    return (urgency * (made - asked).square()).mean()
