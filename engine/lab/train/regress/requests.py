"""Requests that no face fits, as users make them: what the autoencoder learns to mend and what it is judged by."""

from __future__ import annotations

import torch
from torch import Tensor


def salt_and_pepper(controls: Tensor, low: Tensor, high: Tensor, share: float, rng: torch.Generator) -> Tensor:
    """Throw a share of control values, (batch, controls, frames) in mm, to their lowest or highest (BSBS19 section 4.3)."""
    hit = torch.rand(controls.shape, generator=rng) < share
    salt = torch.rand(controls.shape, generator=rng) < 0.5
    return torch.where(hit, torch.where(salt, high, low), controls)


def exaggerated(controls: Tensor, rest: Tensor, factor: Tensor | float) -> Tensor:
    """Scale the departure of controls, (batch, controls, frames), from the neutral face's, (1, controls, 1)."""
    return rest + factor * (controls - rest)


def contradictory(controls: Tensor, rng: torch.Generator) -> Tensor:
    """Give each window one to all but one of its control curves from another window of the batch."""
    batch, count, _ = controls.shape
    other = controls[torch.randperm(batch, generator=rng)]
    swapped = torch.rand((batch, count, 1), generator=rng).argsort(dim=1)  # a random order of controls in each window
    limit = torch.randint(1, max(2, count), (batch, 1, 1), generator=rng)
    return torch.where(swapped < limit, other, controls)
