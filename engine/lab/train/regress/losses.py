"""The terms that training minimises: weights, distances on the face (BSBS19 equation 1), velocity."""

from __future__ import annotations

import torch
from torch import Tensor

CLOSED_MM = 3.0  # distances of this order are lips and lids about to meet


def distance_error(made: Tensor, asked: Tensor, closure_gain: float) -> Tensor:
    """Return the mean squared error of distances, in mm^2, raised by up to `closure_gain` where lips or lids meet.

    Where they should meet and where they do: a closure invented weighs like a closure missed.
    """
    nearer = torch.minimum(made.detach(), asked)
    urgency = 1.0 + closure_gain * torch.exp(-((nearer / CLOSED_MM) ** 2))
    return (urgency * (made - asked).square()).mean()
