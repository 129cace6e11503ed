"""Losses of the filling network: errors where the context determines the motion, an energy score where it does not."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

STRETCHES = (1, 16, 64)  # frames


@dataclass(frozen=True)
class Batch:
    """Windows of truth with the base motion of their fills; all (batch, frames, ...) float32."""

    truth: Tensor
    base: Tensor
    blend: Tensor
    features: Tensor
    hole: Tensor
    certainty: Tensor


@dataclass(frozen=True)
class Shares:
    """How much each term counts; on means, where the paper sums."""

    values: float = 30.0
    squares: float = 60.0  # of values: medians alone would leave flat what moves seldom
    velocities: float = 30.0
    distances: float = 0.1  # per mm
    far: float = 0.0  # how much these count where nothing settles the pose; the rest is left to the terms below
    scatter: float = 60.0
    spectrum: float = 150.0
    adversary: float = 0.05
    penalty: float = 1.0


def fill_losses(filled: Tensor, batch: Batch, distances: torch.nn.Module, shares: Shares) -> dict[str, Tensor]:
    """Return per-window terms (batch,): values and distances (BSS20 equations 1 and 2) and velocities."""
    trust = shares.far + (1 - shares.far) * batch.certainty
    inside = batch.hole.amax(dim=2, keepdim=True)
    room = batch.hole.sum(dim=(1, 2)).clamp(min=1)
    off = (filled - batch.truth) * trust
    apart = (distances(filled) - distances(batch.truth)) * inside * trust
    return {
        "values": shares.values * (off.abs() * batch.hole).sum(dim=(1, 2)) / room,
        "squares": shares.squares * (off.square() * batch.hole).sum(dim=(1, 2)) / room,
        "velocities": shares.velocities * off.diff(dim=1).abs().sum(dim=(1, 2)) / room,
        "distances": shares.distances * apart.abs().mean(dim=2).sum(dim=1) / inside.sum(dim=(1, 2)).clamp(min=1),
    }


def spectrum_gap(filled: Tensor, batch: Batch, scale: Tensor) -> Tensor:
    """Return how far the amplitudes of filled motion in the holes are from the truth's, whatever their phases.

    Mean over shapes, windows of two lengths and frequencies above zero, in units of the shapes' spread. A fill that
    moves as much as the truth but at other moments costs nothing here, where an error per frame asks for stillness.
    """
    gaps = []
    for length in (16, 64):
        taper = torch.hann_window(length)
        share = batch.hole.unfold(1, length, length // 4).mean(dim=3)  # (batch, windows, 52)
        amplitudes = []
        for motion in (filled, batch.truth):
            cut = (motion / scale).unfold(1, length, length // 4)  # (batch, windows, 52, length)
            power = torch.fft.rfft((cut - cut.mean(dim=3, keepdim=True)) * taper).abs().square()[..., 1:]
            inside = (power * share[..., None]).sum(dim=1) / share.sum(dim=1)[..., None].clamp(min=1e-6)
            amplitudes.append(torch.sqrt(inside + 1e-4) / taper.sum())
        gaps.append((amplitudes[0] - amplitudes[1]).abs().mean())
    return torch.stack(gaps).mean()


def scatter(one_fill: Tensor, other_fill: Tensor, batch: Batch) -> Tensor:
    """Return the energy score of two fills of each window, (batch,), where nothing settles the pose.

    ``(|x - y| + |x' - y|) / 2 - |x - x'| / 2`` with truth y (Gneiting & Raftery 2007, equation 22) is least when fills
    scatter as truths would: near it on average and as far from each other as from it. Distances are root mean squares
    over stretches of a frame, half a second and two, so that whole motions count as well as poses.
    """
    pairs = ((one_fill, batch.truth), (other_fill, batch.truth), (one_fill, other_fill))
    first, second, between = (_apart(a, b, batch) for a, b in pairs)
    return (first + second - between) / 2


def _apart(first: Tensor, second: Tensor, batch: Batch) -> Tensor:
    """Return the mean over stretches of the root mean square difference, (batch,), by how unsettled each is."""
    doubt = batch.hole * (1 - batch.certainty)
    sums = torch.stack([((first - second).square() * doubt).sum(dim=2), doubt.sum(dim=2), batch.hole.sum(dim=2)])
    means = []
    for length in STRETCHES:
        squares, unsettled, room = sums.unfold(2, length, (length + 1) // 2).sum(dim=3)
        distance = torch.sqrt(squares / unsettled.clamp(min=1e-3) + 1e-8)
        means.append((distance * unsettled).sum(dim=1) / room.sum(dim=1).clamp(min=1))
    return torch.stack(means).mean(dim=0)
