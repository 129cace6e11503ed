"""The causal recurrent network of BSS20b section 3, which feeds its estimate back, one frame at a time."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

import torch
from torch import Tensor, nn

from engine.take import MODEL_FPS, SHAPES

_SHAPES = len(SHAPES)
_RATE, _OFFSET = 60.0, 0.1  # units of the network's outputs: per second, and weight


@dataclass(frozen=True)
class CleanConfig:
    """Width and number of the recurrent layers; `first_rate_per_s` is the rate at which an untrained network follows."""

    hidden: int = 128
    layers: int = 1
    first_rate_per_s: float = 120.0


class State(NamedTuple):
    """The recurrent state from one frame to the next.

    Attributes
    ----------
    weights : (batch, 52) the estimate
    velocity : (batch, 52) its derivative, per second
    hidden, cell : (layers, batch, hidden) of the recurrent layers
    """

    weights: Tensor
    velocity: Tensor
    hidden: Tensor
    cell: Tensor

    def detached(self) -> State:
        """Return the same state without gradient."""
        return State(*(part.detach() for part in self))


class CleanNetwork(nn.Module):
    """Predicts the derivative of the estimate from the estimate, its derivative and the corrective derivative (eq. 1, 2).

    The input is first restored frame by frame by a linear map, which starts as ridge regression. The derivative has
    three parts: the difference to the restored input and a correction of it, both at a learned rate, and the face's own
    motion, which is the only part on a lost frame.
    """

    def __init__(self, config: CleanConfig) -> None:
        super().__init__()
        self.config = config
        self.restore = nn.Linear(_SHAPES, _SHAPES)
        self.enter = nn.Linear(4 * _SHAPES + 2, config.hidden)
        self.cells = nn.ModuleList(nn.LSTMCell(config.hidden, config.hidden) for _ in range(config.layers))
        self.leave = nn.Linear(config.hidden, 3 * _SHAPES)
        for layer in (self.restore, self.leave):
            nn.init.zeros_(layer.weight)
            nn.init.zeros_(layer.bias)
        with torch.no_grad():
            self.leave.bias[:_SHAPES] = config.first_rate_per_s / _RATE

    def start(self, weights: Tensor) -> State:
        """Return the state at rest on a first frame, (batch, 52)."""
        still = weights.new_zeros(self.config.layers, len(weights), self.config.hidden)
        return State(weights, torch.zeros_like(weights), still, still)

    def forward(
        self, observed: Tensor, present: Tensor, step_s: Tensor, state: State, *, dropout: float = 0.0
    ) -> State:
        """Advance the state by one frame (equations 1 and 2).

        Parameters
        ----------
        observed : (batch, 52) the tracker's weights, 0..1; of no effect where `present` is 0
        present : (batch, 1) 1 where the tracker had a face, else 0
        step_s : (batch, 1) time since the frame before, seconds
        dropout : share of each layer's output dropped in training
        """
        innovation = (observed + self.restore(observed) - state.weights) * present
        # No gradient through the feedback: round the loop it would grow by 1 / step each frame.
        x = self.enter(_features(state, innovation, present, step_s).detach())
        hidden, cell = [], []
        for layer, recurrent in enumerate(self.cells):
            h, c = recurrent(x, (state.hidden[layer], state.cell[layer]))
            x = x + nn.functional.dropout(h, dropout, dropout > 0)
            hidden.append(h)
            cell.append(c)
        rate, offset, motion = self.leave(x).split(_SHAPES, dim=1)
        follow = (
            -torch.expm1(-step_s * _RATE * nn.functional.softplus(rate)) * present
        )  # share of the way in this frame
        moved = state.weights + follow * (innovation + _OFFSET * offset) + step_s * motion
        weights = moved + (moved.clamp(0.0, 1.0) - moved).detach()  # a clamp that lets gradients through
        return State(weights, (weights - state.weights) / step_s, torch.stack(hidden), torch.stack(cell))


def _features(state: State, innovation: Tensor, present: Tensor, step_s: Tensor) -> Tensor:
    """Return the input of the recurrent layers, (batch, 4 * 52 + 2); asinh compresses the derivatives of spikes."""
    return torch.cat(
        [
            2 * state.weights,
            torch.asinh(state.velocity / 2),
            torch.asinh(innovation / step_s / 2),
            4 * innovation,
            present,
            torch.log(step_s * MODEL_FPS),
        ],
        dim=1,
    )


def run(
    network: CleanNetwork, observed: Tensor, present: Tensor, step_s: Tensor, state: State, *, dropout: float = 0.0
) -> tuple[Tensor, State]:
    """Clean whole sequences: (batch, frames, 52), (batch, frames, 1) twice -> (batch, frames, 52) and the last state."""
    estimates = []
    for index in range(observed.shape[1]):
        state = network(observed[:, index], present[:, index], step_s[:, index], state, dropout=dropout)
        estimates.append(state.weights)
    return torch.stack(estimates, dim=1), state


def config_of(network: CleanNetwork) -> dict[str, Any]:
    """Return a network's configuration, from which `from_config` builds it again."""
    return asdict(network.config)


def from_config(config: dict[str, Any]) -> CleanNetwork:
    """Build a network from a configuration that `config_of` returned."""
    return CleanNetwork(CleanConfig(**config))
