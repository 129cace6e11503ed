"""Where training begins: ridge regression, and how far it is off on people whom it has not seen.

The penalty, and the covariance of errors in whose metric faces are brought onto their controls, are those of people left
out one after another: frames kept aside of the people trained on would choose what knows these people best.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor, nn

from engine.lab.train.regress.data import Windows
from engine.regress.areas import Area
from engine.regress.network import AreaNetwork
from engine.regress.unet import UNet

LEAST = 1e-4  # of a weight, squared: a shape that no error was seen of may still move
WINDOWS = 60  # of a person, by which nobody counts for more than the others


@dataclass(frozen=True)
class _People:
    """Controls, (windows, inputs, frames), weights of the area and of all shapes, of a person each."""

    seen: list[Tensor]
    truth: list[Tensor]
    whole: list[Tensor]


def begin(
    network: AreaNetwork, area: Area, first: Windows, people: Sequence[Windows], penalties: Sequence[float]
) -> dict[float, float]:
    """Standardise, start the regressor as ridge regression and the autoencoder as identity.

    Returns the mean squared error on people left out by penalty; the least was taken.
    """
    inputs, outputs = torch.tensor(area.every_column), torch.tensor(area.shape_columns)
    controls, weights = first.controls[:, inputs], first.weights[:, outputs]
    for unet, curves in ((network.regressor, controls), (network.autoencoder, weights)):
        unet.mean.copy_(curves.mean(dim=(0, 2))[None, :, None])
        unet.scale.copy_(curves.std(dim=(0, 2))[None, :, None].clamp(min=0.02))
    apart = [_thinned(one) for one in people]
    known = _People(
        [one.controls[:, inputs] for one in apart],
        [one.weights[:, outputs] for one in apart],
        [one.weights for one in apart],
    )
    found = {penalty: _left_out(network, known, penalty) for penalty in penalties}
    best = min(found, key=lambda penalty: found[penalty][0])
    if network.constraint is not None:
        network.constraint.covariance.copy_(found[best][1])
    _solve(network.regressor, controls, weights, best)
    autoencoder = network.autoencoder
    with torch.no_grad():
        autoencoder.linear.weight.copy_(torch.diag(autoencoder.scale[0, :, 0])[:, :, None])
        autoencoder.linear.bias.copy_(autoencoder.mean[0, :, 0])  # type: ignore[union-attr]
    return {penalty: error for penalty, (error, _) in found.items()}


def without_further(controls: Tensor, own: int) -> Tensor:
    """Return controls, (batch, inputs, frames), of which only the first ones are given."""
    return torch.cat([controls[:, :own], torch.full_like(controls[:, own:], torch.nan)], dim=1)


def _thinned(windows: Windows) -> Windows:
    step = -(-len(windows.weights) // WINDOWS)
    return Windows(windows.controls[::step], windows.weights[::step])


def _left_out(network: AreaNetwork, people: _People, penalty: float) -> tuple[float, Tensor]:
    """Return the mean squared error on people left out, on their controls, and the covariance of errors before that."""
    made: list[tuple[int, Tensor, Tensor]] = []
    for person in range(len(people.seen)):
        others = [index for index in range(len(people.seen)) if index != person] or [person]
        _solve(
            network.regressor,
            torch.cat([people.seen[index] for index in others]),
            torch.cat([people.truth[index] for index in others]),
            penalty,
        )
        own = network.regressor.config.inputs
        seen = people.seen[person]
        for asked in [without_further(seen, own), seen] if network.regressor.config.further else [seen]:
            with torch.no_grad():
                made.append((person, asked, network.regressor.straight(asked)))
    errors = [(plain - people.truth[person]).mT.flatten(0, 1) for person, _, plain in made]
    covariance = torch.stack([error.T @ error / len(error) for error in errors]).mean(dim=0)
    covariance += LEAST * torch.eye(len(covariance))
    if network.constraint is not None:
        network.constraint.covariance.copy_(covariance)
    found = []
    for person, asked, plain in made:
        with torch.no_grad():
            onto = network.constrained(plain.clamp(0.0, 1.0), asked, people.whole[person], full=False)
        found.append((onto - people.truth[person]).square().mean())
    return float(torch.stack(found).mean()), covariance


def _solve(regressor: UNet, controls: Tensor, weights: Tensor, penalty: float) -> None:
    """Solve each linear part of a regressor on windows of recorded faces."""
    own = regressor.config.inputs
    x = (controls - regressor.mean) / regressor.scale
    _ridge(regressor.linear, regressor.bent(x[:, :own]), weights, penalty)
    if regressor.more is not None:
        _ridge(regressor.more, regressor.bent(x), weights, penalty)


def _ridge(layer: nn.Conv1d, seen: Tensor, weights: Tensor, penalty: float) -> None:
    """Minimise the mean of ``|W - X B - b|^2`` plus ``penalty |B|^2``."""
    x, y = seen.mT.flatten(0, 1).double(), weights.mT.flatten(0, 1).double()
    ahead, centre = x.mean(dim=0), y.mean(dim=0)
    gram = (x - ahead).T @ (x - ahead) / len(x) + penalty * torch.eye(x.shape[1], dtype=x.dtype)
    slope = torch.linalg.solve(gram, (x - ahead).T @ (y - centre) / len(x))
    with torch.no_grad():
        layer.weight.copy_(slope.T[:, :, None])
        layer.bias.copy_(centre - ahead @ slope)  # type: ignore[union-attr]
